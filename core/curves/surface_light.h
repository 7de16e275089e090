#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/curves/curve_light.h"
#include "core/curves/curve_transport.h"
#include "core/curves/lobe_tables.h"
#include "core/curves/surface_kernel.h"
#include "core/transport/curve_receivers.h"

namespace rimlight {

/// A surface's four points as kernels read them.
struct PreparedSurface {
  std::array<LobePoint, kSurfacePoints> points;
  std::array<DiffuseFactors, kSurfacePoints> diffuse;  // the tint in it
  std::array<bool, kSurfacePoints> faces_viewer{};     // else nothing is reflected
};
PreparedSurface prepare(const CurveSurface& surface, const CurveMaterialState& state,
                        const LobeTables& tables);

/// What a surface sees of some points of light, with its share of the pixel in it. Reused from
/// surface to surface; one thread.
class SurfaceSight {
 public:
  /// All texels.
  void look_at_texels(const SkyVisibilityView& view, std::size_t surface, float share,
                      const CurveLight& light);
  /// Means over 4 × 4 texels.
  void look_at_means(const SkyVisibilityView& view, std::size_t surface, float share,
                     const CurveLight& light);
  /// The strongest texels.
  void look_at_strongest(const SkyVisibilityView& view, std::size_t surface, float share,
                         const CurveLight& light);

  /// What a point of the surface sees in its quarter of the texels. Until the next call.
  LitQuarter quarter(std::size_t quarter, const SurfacePoint& point);

 private:
  void begin(const LightPoints& points, const PointRadiance& radiance);
  void add_vector(std::size_t vector);

  const LightPoints* points_ = nullptr;
  const PointRadiance* radiance_ = nullptr;
  AlignedVector<float> visibility_;
  std::vector<std::uint32_t> seen_, facing_;  // vectors
};

/// The radiance that a point adds: of its sums, without T′.
Vec3f radiance_of(const LobeSums& sums, const DiffuseFactors& diffuse);

/// What a row shows of all texels: with `bins` (kBinFloats) without the factor of the tables' axis,
/// whose T′ is added to them.
Vec3f sum_row(const CurveReceivers& receivers, const CurvePanel& panel, std::size_t row,
              const CurveLight& light, const CurveMaterialState& state, const LobeTables& tables,
              float* bins);

}  // namespace rimlight
