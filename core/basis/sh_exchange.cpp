#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/basis/sh_rotation_kernel.h"
#include "core/math/quadrature.h"

namespace rimlight::sh {
namespace {

/// Which m a slot of a class holds: ±(top − 2 slot), and none where that would be −0.
struct SlotClass {
  int top;
  int sign;
  int slots;

  int m(int slot) const { return sign * (top - 2 * slot); }
  bool empty(int slot) const { return sign < 0 && m(slot) == 0; }
};

SlotClass aligned(int l) { return {l, 1, aligned_slots(l)}; }
SlotClass raised(int l) { return {l - 1, 1, raised_slots(l)}; }
SlotClass sideways(int l) { return {l, -1, aligned_slots(l)}; }
SlotClass twisted(int l) { return {l - 1, -1, raised_slots(l)}; }

/// The exchange of the bands `first` … `last`.
class ExchangeTable {
 public:
  ExchangeTable(int first, int last)
      : first_(first), last_(last), bands_(static_cast<std::size_t>(last - first + 1)) {
    lay_out();
    // Products of two bands are of degree 2l: so many rows and steps around are exact. Even, so
    // that no row is on the equator, which two octants would share.
    const int rows = last + 2 - last % 2;
    const int turn = 2 * rows;
    // Within a block the integrand is even in x, y and z: one octant of eight.
    for (const QuadraturePoint& point : gauss_legendre(rows)) {
      if (point.position < 0) continue;
      const double across = std::sqrt((1 - point.position) * (1 + point.position));
      for (int step = 0; step < turn / 4; ++step) {
        const double angle = 2 * std::numbers::pi * (step + 0.5) / turn;
        add({across * std::cos(angle), across * std::sin(angle), point.position},
            8 * point.weight * 2 * std::numbers::pi / turn);
      }
    }
  }

  const ExchangeBand& band(int l) const { return bands_[static_cast<std::size_t>(l - first_)]; }

 private:
  void lay_out() {
    std::size_t size = 0;
    const auto place = [&](const SlotClass& from, const SlotClass& to) {
      const std::size_t first = size;
      size += static_cast<std::size_t>(from.slots * padded_slots(to.slots));
      return first;
    };
    std::vector<std::array<std::size_t, 4>> first;
    for (int l = first_; l <= last_; ++l) {
      first.push_back({place(aligned(l), aligned(l)), place(twisted(l), twisted(l)),
                       place(raised(l), sideways(l)), place(sideways(l), raised(l))});
    }
    values_.assign(size, 0.0);
    for (std::size_t l = 0; l < first.size(); ++l) {
      bands_[l] = {values_.data() + first[l][0], values_.data() + first[l][1],
                   values_.data() + first[l][2], values_.data() + first[l][3]};
    }
  }

  /// One point of the quadrature, on all blocks.
  void add(const Vec3d& direction, double weight) {
    const std::vector<double> plain = evaluate(direction, last_);
    const std::vector<double> exchanged = evaluate({direction.x, direction.z, direction.y}, last_);
    const auto add_block = [&](int l, const double* block, const SlotClass& from,
                               const SlotClass& to) {
      double* column = values_.data() + (block - values_.data());
      for (int i = 0; i < from.slots; ++i, column += padded_slots(to.slots)) {
        if (from.empty(i)) continue;
        const double factor = weight * exchanged[index(l, from.m(i))];
        for (int j = 0; j < to.slots; ++j) {
          if (!to.empty(j)) column[j] += factor * plain[index(l, to.m(j))];
        }
      }
    };
    for (int l = first_; l <= last_; ++l) {
      const ExchangeBand& blocks = band(l);
      add_block(l, blocks.aligned_to_aligned, aligned(l), aligned(l));
      add_block(l, blocks.twisted_to_twisted, twisted(l), twisted(l));
      add_block(l, blocks.raised_to_sideways, raised(l), sideways(l));
      add_block(l, blocks.sideways_to_raised, sideways(l), raised(l));
    }
  }

  int first_, last_;
  AlignedVector<double> values_;
  std::vector<ExchangeBand> bands_;
};

}  // namespace

const ExchangeBand& exchange_band(int l) {
  static const ExchangeTable kUsual(0, kLargestDegree);
  if (l <= kLargestDegree) return kUsual.band(l);
  static const ExchangeTable kOfLights(kLargestDegree + 1, kLargestLightDegree);
  return kOfLights.band(l);
}

}  // namespace rimlight::sh
