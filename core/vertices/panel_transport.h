#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/base/half.h"
#include "core/transport/vertex_transport.h"

namespace rimlight {

/// Transport of panels of vertices that is applied to lights again and again, with a panel's own
/// choice of how many bands it takes: those that can matter.
///
/// What the bands above K add to a vertex, Σ_k T_k · L_k, has over all rotations of the light the
/// mean square Σ_{k > K} ‖T_k‖² ‖L_k‖² / (2k + 1): two independent directions in 2k + 1 dimensions.
/// A panel takes the fewest bands that leave the mean of this over its vertices, in its worst
/// channel, at or below tolerance². Norms of bands do not change when a light turns, so neither
/// does the choice, and what is shown is linear in the light: nothing flickers.
///
/// fp16 storage, fp32 sums, parallel over panels; the same bits for any number of threads. Nothing
/// is allocated after the first use with as many panels. One thread at a time.
class PanelTransport {
 public:
  /// Writes one panel, [channels][(degree + 1)²][kBatchVertices], zeros in lanes of padding.
  using Fill = std::function<void(std::size_t panel, std::span<float> values)>;

  /// Makes room and fills it; panels are filled in parallel. `channels` 1 or 3.
  struct Shape {
    std::size_t vertices = 0;  // packed; the rest of the last panel is padding
    std::size_t channels = 1;
    int degree = 0;
  };
  void assign(const Shape& shape, const Fill& fill);

  /// Chooses the bands of each panel under a light [3][(K + 1)²]; those beyond either degree count
  /// as zero. Tolerance in the units of the sums; 0 takes all bands that the light has.
  void choose_bands(std::span<const float> light, float tolerance);

  /// to [panel][3][kBatchVertices]: the sums over each panel's bands, as chosen last. CheckFailure
  /// unless choose_bands() was called since assign().
  void apply(std::span<const float> light, std::span<float> to) const;

  const Shape& shape() const { return shape_; }
  std::size_t panel_count() const { return batch_count(shape_.vertices); }
  /// The share of all coefficients that were chosen away; 0 when there are none.
  double left_out() const;
  std::size_t bytes() const { return values_.size() * sizeof(Half); }

 private:
  void store(std::size_t panel, std::span<const float> values);

  Shape shape_;
  AlignedVector<Half> values_;
  std::vector<float> band_squares_;  // [panel][channels][degree + 1]: ‖T_k‖², mean over vertices
  std::vector<int> last_band_;       // [panel]
  AlignedVector<float> light_;  // scratch of choose_bands(): ‖L_k‖²/(2k + 1), [3][degree + 1]
};

}  // namespace rimlight
