#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/curves/curve_light.h"
#include "core/curves/curve_material_state.h"
#include "core/curves/curve_transport.h"
#include "core/curves/lobe_tables.h"

namespace rimlight {

/// Rows that are left out of a quick image: of 2, 4 or 8 pixels beside each other (8 are 4 × 2)
/// whose normals are within 3.6° (8.1° of 8), one is shaded, and the others take its radiance by
/// their share of the pixel.
enum class QuickDetail : std::uint8_t { every_row, one_of_two, one_of_four, one_of_eight };
/// As coarse as so many rows need, by their number alone: up to 24,000 each is shaded.
QuickDetail quick_detail(std::size_t row_count);

/// Makes images without T′, from materials as they are: rows as [panel][3][kPanelRows]. Allocates
/// nothing after warm-up. One thread at a time; computes on all cores.
class QuickShader {
 public:
  /// `states`: of each material; they and `rows` must outlive it.
  QuickShader(const CurveTransport& rows, std::span<const CurveMaterialState> states);

  /// A material's state is another than before.
  void change(std::size_t material);

  /// What the rows of some panels show; the image's other panels stay as they are.
  ///
  /// Quickly: the light's strongest texels exactly, all else from means of radiance and of
  /// visibility over 4 × 4 texels. Exact when all texels are among the strongest, and each row is
  /// shaded. `abandon` (may be empty) is asked before each panel, from several threads; false when
  /// it answered true, and then `image` is unspecified.
  [[nodiscard]] bool shade(const CurveLight& light, std::span<const std::uint32_t> panels,
                           QuickDetail detail, const std::function<bool()>& abandon,
                           std::span<float> image) const;

  /// Σ over the rows of these panels and channels of (image − exact)², estimated from `sample` rows
  /// drawn by `seed`, evenly among them.
  double sampled_squared_error(const CurveLight& light, std::span<const std::uint32_t> panels,
                               std::span<const float> image, std::size_t sample,
                               std::uint64_t seed);

 private:
  /// A row that stands for `count` ones.
  struct SampledRow {
    std::size_t panel = 0, row = 0, count = 0;
    double squared_error = 0;
  };

  void draw_rows(std::span<const std::uint32_t> panels, std::size_t sample, std::uint64_t seed);

  const CurveTransport& rows_;
  std::span<const CurveMaterialState> states_;
  std::vector<LobeTables> tables_;  // [material]
  std::vector<SampledRow> sample_;
};

/// One row exactly: all texels, as T′ · c + fixed is but for its rounding.
Vec3f shade_exactly(const CurveReceivers& receivers, const CurvePanel& panel, std::size_t row,
                    const CurveLight& light, const CurveMaterialState& state);

}  // namespace rimlight
