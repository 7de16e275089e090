#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace rimlight {

/// What the header of a .npy file says, as it stands there.
struct NpyHeader {
  std::string descr;
  bool fortran_order = false;
  std::vector<std::size_t> shape;
};

/// Reads the header's text, a Python dictionary such as
///     {'descr': '<f4', 'fortran_order': False, 'shape': (3, 4), }
/// Throws Error, with `name` and the field, at anything else.
NpyHeader parse_npy_header(std::string_view text, const std::string& name);

}  // namespace rimlight
