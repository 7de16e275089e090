#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/vertices/vertex_products.h"

namespace rimlight {

/// Some panels of vertices whose highlights are calculated degree by degree. Those that are not to
/// go on are dropped; when enough are, the rest is packed into full panels again, so that the
/// matrix products stay as dense as those of the full calculation.
///
/// Per vertex (Lee 2014, §5.1.2) the increment of degree l is that of S = g · M O when M, the
/// visibility O and the turned lobe g grow by the band l. M being symmetric, it needs neither R nor
/// any state but S:
///
///     ΔS_l = Σ_{i in l} ( g_i Σ_{j ≤ l} M_ij O_j  +  O_i Σ_{j < l} M_ij g_j )
///
/// The increments of all degrees sum to the full S, and take as many operations.
/// Made once a thread and reused: nothing is allocated after the first group. One thread at a time.
class LevelGroup {
 public:
  static constexpr std::size_t kPanels = 16;
  static constexpr std::size_t kVertices = kPanels * kBatchVertices;

  /// Takes up to kPanels panels of a selection, with S = 0.
  void load(const VertexProducts& products, const VertexSelection& selection,
            const VertexGloss& gloss, std::size_t first_panel);

  /// S += ΔS_l of all that are held.
  void add_degree(const VertexProducts& products, int degree);
  /// Remembers S as the base that differences() are taken from.
  void set_base();

  /// Keeps the vertices whose difference from the base is at least `threshold` in some channel, and
  /// writes S of the others; returns how many are kept.
  std::size_t keep_above(float threshold, std::span<float> to);
  /// Writes S of all that are held: to [panel of the group][3][kBatchVertices].
  void write(std::span<float> to) const;

  std::size_t vertex_count() const { return alive_count_; }
  /// Calls visit(lane) for those that are held; in the group: panel · kBatchVertices + lane.
  template <typename Visit>
  void for_each_lane(const Visit& visit) const {
    for (std::size_t packed = 0; packed < count_; ++packed) {
      if (is_alive(packed)) visit(std::size_t{lanes_[packed]});
    }
  }

 private:
  /// S, then the base, as rows of a panel.
  static constexpr std::size_t kStateRows = 2 * kLightChannels;
  std::size_t panel_size() const { return coefficients_ * kBatchVertices; }
  float* state(std::size_t panel) { return state_.data() + panel * kStateRows * kBatchVertices; }
  const float* state(std::size_t panel) const {
    return state_.data() + panel * kStateRows * kBatchVertices;
  }
  std::size_t panel_count() const { return batch_count(count_); }
  std::uint64_t lanes_above(std::size_t panel, float threshold) const;
  void write_lane(std::size_t packed, std::span<float> to) const;
  void set_all_alive();
  void pack();

  bool is_alive(std::size_t packed) const {
    return ((alive_[packed / kBatchVertices] >> (packed % kBatchVertices)) & 1) != 0;
  }

  std::size_t coefficients_ = 0;
  std::size_t count_ = 0, alive_count_ = 0;  // in the panels; of those, not dropped
  std::array<std::uint64_t, kPanels> alive_{};
  AlignedVector<float> visibility_, lobes_, state_;
  std::array<std::uint16_t, kVertices> lanes_{};
};

}  // namespace rimlight
