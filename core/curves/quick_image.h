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
[[nodiscard]] bool shade_quickly(const CurveTransport& rows, const CurveLight& light,
                                 std::span<const CurveMaterialState> states,
                                 std::span<const std::uint32_t> panels,
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
