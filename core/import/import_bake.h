#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/bake/transport_bake.h"
#include "core/import/coverage_mask.h"
#include "core/import/direction_cells.h"
#include "core/import/direction_list.h"
#include "core/import/resampling_error.h"
#include "core/import/transport_resampler.h"
#include "core/import/transport_source.h"
#include "core/light/environment.h"
#include "core/math/camera.h"

namespace rimlight {

/// How imported transport becomes a bake.
struct ImportSettings {
  std::string name;  // of the scene
  ColumnUnit unit = ColumnUnit::irradiance;
  SphericalCap cap;     // that the directions cover; beyond it the transport is zero
  int cube_size = 0;    // N: a power of two, 4 … 128; 0 chooses by the number of directions
  double psnr_db = 50;  // of the compressed transport
  std::optional<CoverageMask> mask;       // none: every pixel is covered
  std::vector<Environment> environments;  // at least one
  Camera camera;  // only what lies behind pixels with coverage below 1 is seen through it
};

struct ImportSummary {
  double seconds = 0;
  PixelLayout pixels;
  std::size_t directions = 0;
  int cube_size = 0;
  double weight_sum = 0;  // of the directions' weights, given or Voronoi; the cap's solid angle is
  double covered = 0;     // this
  double largest_weight = 0, median_weight = 0;
  std::size_t largest_direction = 0;  // whose weight is the largest
  std::vector<ResamplingError> resampling;
  std::size_t bytes = 0;     // of stored transport
  double worst_psnr_db = 0;  // of the compressed transport, over the check lights
  std::string worst_light;
};

/// Opens the transport; the folder is one where temporary files may lie, on the bake's disk.
using MakeSource =
    std::function<std::unique_ptr<TransportSource>(const std::filesystem::path& scratch_folder)>;

/// The cube map's size that import_bake chooses: the smallest from 8 to 64 with three texels or
/// more a direction.
int cube_size_for(std::size_t directions);

/// Transport from elsewhere as a bake, `folder` (NAME.bake): resampled from its directions to a
/// cube map (TransportResampler), with weights from the list or else the solid angles of the
/// directions' Voronoi cells, transformed to Haar coefficients and compressed to psnr_db. The
/// resampling error is measured under "sunny", "studio" and "cathedral" (each projected to a fine
/// cube map and averaged over the directions' cells, against the same by way of the bake's texels)
/// and stands in the summary and the manifest. Uses all cores; memory: one group's rows and texels
/// a core, and some pictures. Throws Error: a direction outside the cap, another number of
/// directions than the source has columns, a mask of another size or that covers nothing, and
/// whatever the source and the disk say; then nothing is left of the bake. An import does not
/// resume.
ImportSummary import_bake(const MakeSource& make_source, const DirectionList& directions,
                          const ImportSettings& settings, const std::filesystem::path& folder,
                          const std::function<void(const BakeProgress&)>& progress);

}  // namespace rimlight
