#include "core/material/measured_brdf.h"

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/material/cornell_brdf.h"
#include "core/material/merl_brdf.h"
#include "core/material/rgl_brdf.h"

namespace rimlight {
namespace {

constexpr std::size_t kLargestText = std::size_t{64} << 20;

}  // namespace

std::optional<Vec3d> MeasuredBrdf::at(const HalfDifference& angles) const {
  const DirectionPair pair = direction_pair(angles);
  if (!(pair.in.z > 0 && pair.out.z > 0)) return std::nullopt;
  return value(angles, pair);
}

std::optional<Vec3d> MeasuredBrdf::at(const Vec3d& in, const Vec3d& out) const {
  if (!(in.z > 0 && out.z > 0)) return std::nullopt;
  return value(half_difference(in, out), {in, out});
}

std::unique_ptr<const MeasuredBrdf> load_measured_brdf(const std::filesystem::path& path) {
  const std::string ending = path.extension().string(), name = path.string();
  if (ending == ".binary") {
    return std::make_unique<MerlBrdf>(MappedFile(path, kMerlBytes).bytes(), name);
  }
  if (ending == ".brdf") {
    return std::make_unique<CornellBrdf>(read_file(path, kLargestText), name);
  }
  if (ending == ".bsdf") {
    return std::make_unique<RglBrdf>(MappedFile(path, kLargestText).bytes(), name);
  }
  throw Error(name, "a name that ends in " + quote(ending), ".binary, .brdf or .bsdf");
}

}  // namespace rimlight
