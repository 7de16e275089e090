#include "core/transport/bake_folder.h"

#include "core/basis/cube_map.h"
#include "core/transport/bake_manifest.h"
#include "core/transport/bake_tensors.h"
#include "core/transport/curve_tensors.h"

namespace rimlight {

Bake::Bake(const std::filesystem::path& folder)
    : files_(folder), manifest_(read_manifest(files_.manifest())) {
  const auto path = [this](const char* name) { return files_.path(name); };
  const std::size_t columns = cube::texel_count(manifest_.cube_size);
  transport_ = read_transport(files_.file(kTransportFile), path(kTransportFile),
                              manifest_.pixels.tile_count(), columns);
  column_bytes_ = count_column_bytes(transport_);
  part_sizes_ = measure_parts(transport_);
  const TensorFile& pixels = files_.file(kPixelsFile);
  coverage_ = read_coverage(pixels, path(kPixelsFile), manifest_.pixels);
  reflectance_ = read_reflectance(pixels, path(kPixelsFile), manifest_.pixels);
  sketch_ = read_sketch(files_.file(kSketchFile), path(kSketchFile), columns);
  environments_ = files_.read_environments();
  if (!has_curves()) return;
  const TensorFile& curves = files_.file(kCurvesFile);
  surfaces_ = read_curve_surfaces(curves, path(kCurvesFile), manifest_);
  visibility_ = read_sky_visibility(curves, path(kCurvesFile), manifest_, surfaces_.size());
  read_measured_factors(curves, path(kCurvesFile), manifest_);
}

CurveReceivers Bake::curve_receivers() const {
  return {manifest_.materials, manifest_.measured_brdfs, surfaces_, visibility_};
}

Bake::~Bake() = default;

}  // namespace rimlight
