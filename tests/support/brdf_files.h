#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/math/vec.h"

namespace rimlight::test {

/// A MERL file whose stored numbers a function of channel and bin gives, header included.
std::string merl_file(const std::function<double(int channel, std::size_t bin)>& stored);

/// One line of a Cornell file: θ_i φ_i θ_s φ_s and a value for each wavelength.
struct CornellLine {
  std::array<double, 4> angles{};
  std::vector<double> values;
};
std::string cornell_file(const std::vector<double>& wavelengths,
                         const std::vector<CornellLine>& lines);

/// A float field of an RGL tensor file.
struct RglField {
  std::string name;
  std::vector<std::uint64_t> shape;
  std::vector<float> values;
  std::uint8_t type = 10;
};
std::string rgl_file(const std::vector<RglField>& fields);

/// The fields of a small isotropic material: `ndf`, `sigma` and `rgb` constant, half vectors
/// visible alike, so that f = ndf · rgb / (4 sigma cos θ_o).
std::vector<RglField> small_rgl_fields(float ndf, float sigma, const Vec3f& rgb);

}  // namespace rimlight::test
