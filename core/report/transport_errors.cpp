#include "core/report/transport_errors.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/base/error.h"

namespace rimlight {
namespace {

constexpr std::size_t kLanes = PixelLayout::kGroupReceivers;

double squared(const Vec3f& value) {
  const Vec3d wide = {value.x, value.y, value.z};
  return dot(wide, wide);
}

double squared_norm(const std::vector<Vec3f>& image) {
  double sum = 0;
  for (const Vec3f& value : image) sum += squared(value);
  return sum;
}

double squared_distance(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += squared(a[i] - b[i]);
  return sum;
}

/// Where the checked groups lie among all that have rows.
std::vector<std::size_t> places_of(const ReferenceRows& checked, const ReferenceRows& rows,
                                   const Bake& bake) {
  std::vector<std::size_t> places;
  for (const std::uint64_t group : checked.groups()) {
    const auto at = std::ranges::lower_bound(rows.groups(), group);
    if (at == rows.groups().end() || *at != group) {
      throw Error((bake.folder() / kReferenceFile).string(),
                  "rows traced again of receiver " + std::to_string(group),
                  "only of receivers that have rows");
    }
    places.push_back(static_cast<std::size_t>(at - rows.groups().begin()));
  }
  return places;
}

std::vector<Vec3f> select(const std::vector<Vec3f>& image, const std::vector<std::size_t>& groups) {
  std::vector<Vec3f> result;
  for (const std::size_t group : groups) {
    const auto first = image.begin() + static_cast<std::ptrdiff_t>(group * kLanes);
    result.insert(result.end(), first, first + static_cast<std::ptrdiff_t>(kLanes));
  }
  return result;
}

}  // namespace

TransportErrors::TransportErrors(const Bake& bake)
    : rows_(ReferenceRows::open(bake)),
      retraced_(ReferenceRows::open(bake, ReferenceRows::Kind::retraced)),
      finer_(ReferenceRows::open(bake, ReferenceRows::Kind::finer)) {
  if (!rows_) return;
  if (finer_) finer_size_ = 2 * bake.manifest().cube_size;
  if (retraced_) place_ = places_of(*retraced_, *rows_, bake);
  if (!finer_) return;
  const auto of_finer = places_of(*finer_, *rows_, bake);
  if (retraced_ && of_finer != place_) {
    throw Error((bake.folder() / kReferenceFile).string(),
                "finer rows of other receivers than those traced again", "the same");
  }
  place_ = of_finer;
}

std::vector<TransportError> TransportErrors::find(std::span<const CubeLight> lights,
                                                  std::span<const CubeLight> finer_lights) const {
  std::vector<TransportError> result(lights.size());
  if (place_.empty()) return result;
  const auto images = rows_->multiply(lights);
  std::vector<std::vector<Vec3f>> again, finer;
  if (retraced_) again = retraced_->multiply(lights);
  if (finer_) {
    RIMLIGHT_CHECK_EQ(finer_lights.size(), lights.size());
    finer = finer_->multiply(finer_lights);
  }
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const std::vector<Vec3f> image = select(images[i], place_);
    const double size = squared_norm(image);
    if (!(size > 0)) continue;
    if (retraced_) result[i].noise = std::sqrt(squared_distance(image, again[i]) / 2 / size);
    if (finer_) result[i].resolution = std::sqrt(squared_norm(finer[i]) / size);
  }
  return result;
}

}  // namespace rimlight
