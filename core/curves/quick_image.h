#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "core/curves/curve_light.h"
#include "core/curves/curve_material_state.h"
#include "core/curves/curve_transport.h"

namespace rimlight {

/// What the rows of some panels show, without T′: states as [material], rows as
/// [panel][3][kPanelRows]. The image's other panels stay as they are.
///
/// Quickly: the light's strongest texels exactly, all else from means of radiance and of visibility
/// over 4 × 4 texels. Exact when all texels are among the strongest. On all cores; `abandon` (may
/// be empty) is asked before each panel, from several threads; false when it answered true, and
/// then `image` is unspecified.
///
/// `detail` leaves rows out: of pixels beside each other whose normals are within 3.6°, one is
/// shaded, and the others take its radiance by their share of the pixel.
enum class QuickDetail : std::uint8_t { every_row, one_of_two, one_of_four };
/// As coarse as so many rows need, by their number alone: up to 40,000 each is shaded.
QuickDetail quick_detail(std::size_t row_count);
[[nodiscard]] bool shade_quickly(const CurveTransport& rows, const CurveLight& light,
                                 std::span<const CurveMaterialState> states,
                                 std::span<const std::uint32_t> panels, QuickDetail detail,
                                 const std::function<bool()>& abandon, std::span<float> image);

/// One row exactly: all texels, as T′ · c + fixed is but for its rounding.
Vec3f shade_exactly(const CurveReceivers& receivers, const CurvePanel& panel, std::size_t row,
                    const CurveLight& light, const CurveMaterialState& state);

/// Σ over the rows of these panels and channels of (image − exact)², estimated from `sample` rows
/// drawn by `seed`, evenly among them. On all cores.
double sampled_squared_error(const CurveTransport& rows, const CurveLight& light,
                             std::span<const CurveMaterialState> states,
                             std::span<const std::uint32_t> panels, std::span<const float> image,
                             std::size_t sample, std::uint64_t seed);

}  // namespace rimlight
