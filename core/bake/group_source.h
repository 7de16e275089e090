#pragma once

#include <array>
#include <cstddef>

#include "core/bake/group.h"
#include "core/transport/receivers.h"

namespace rimlight {

/// One group's rows of M, before anything is left out.
struct BakedGroup {
  bool empty = true;       // no receiver in it: the other members hold nothing
  GroupRows coefficients;  // Haar, [coefficient][3][64]
  std::array<float, kGroupLanes> coverage{};

  explicit BakedGroup(int cube_size) : coefficients(cube_size) {}
};

/// Where a bake's transport comes from, group by group. A group's rows depend on its place alone:
/// any thread, any order.
class GroupSource {
 public:
  virtual ~GroupSource() = default;

  virtual const PixelLayout& layout() const = 0;
  virtual int cube_size() const = 0;  // N
  /// About how large M's smaller numbers are: where the search for a compression begins. Above 0.
  virtual float typical_size() const = 0;
  /// Fills all of `group`.
  virtual void find_rows(std::size_t first_receiver, BakedGroup& group) const = 0;
  /// Whether the group has any receiver: false where find_rows() would leave it empty.
  virtual bool has_receivers(std::size_t first_receiver) const = 0;
};

}  // namespace rimlight
