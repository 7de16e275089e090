#include "core/material/rgl_brdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;

double angle_share(double theta) { return std::sqrt(std::max(0.0, theta) * 2 / kPi); }

/// 0 in `expected` stands for any size of a grid.
void check_shape(const RglTensor& tensor, const std::vector<std::size_t>& expected,
                 const std::string& where) {
  std::string found = "shape", wanted = "shape";
  bool same = true;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::size_t size = tensor.shape[i];
    same = same && (expected[i] == 0 ? size >= 2 && size <= 4096 : size == expected[i]);
    found += " " + std::to_string(size);
    wanted += expected[i] == 0 ? " (2 to 4096)" : " " + std::to_string(expected[i]);
  }
  if (!same) throw Error(where, found, wanted);
}

RglTensor read(const RglTensorFile& file, const std::string& name,
               const std::vector<std::size_t>& shape) {
  RglTensor tensor = file.tensor(name, shape.size());
  check_shape(tensor, shape, file.source() + ": field " + quote(name));
  return tensor;
}

/// One azimuth, or two that say the same.
std::size_t turn_count(const RglTensorFile& file) {
  const std::size_t turns = file.tensor("phi_i", 1).values.size();
  if (turns == 1 || turns == 2) return turns;
  throw Error(file.source() + ": field \"phi_i\"", std::to_string(turns) + " azimuths",
              "one: an isotropic material");
}

std::vector<float> read_angles(const RglTensorFile& file) {
  if (!file.has("rgb")) throw Error(file.source(), "no field \"rgb\"", "an RGB material");
  const RglTensor tensor = read(file, "theta_i", {0});
  for (std::size_t i = 1; i < tensor.values.size(); ++i) {
    if (tensor.values[i - 1] < tensor.values[i]) continue;
    throw Error(file.source() + ": field \"theta_i\"", "angles that fall", "angles that rise");
  }
  return tensor.values;
}

RglGrid read_grid(const RglTensorFile& file, const std::string& name) {
  const RglTensor tensor = read(file, name, {0, 0});
  return {tensor.shape[1], tensor.shape[0], tensor.values};
}

/// The first `count` grids of a tensor whose last two dimensions are a grid's.
std::vector<RglGrid> grids_of(const RglTensor& tensor, std::size_t count) {
  const std::size_t columns = tensor.shape.back(), rows = tensor.shape[tensor.shape.size() - 2];
  const std::span<const float> values(tensor.values);
  std::vector<RglGrid> grids;
  for (std::size_t i = 0; i < count; ++i) {
    grids.emplace_back(columns, rows, values.subspan(i * columns * rows, columns * rows));
  }
  return grids;
}

}  // namespace

RglBrdf::RglBrdf(const RglTensorFile& file)
    : theta_(read_angles(file)),
      sigma_(read_grid(file, "sigma")),
      ndf_(read_grid(file, "ndf")),
      visible_(
          grids_of(read(file, "vndf", {turn_count(file), theta_.size(), 0, 0}), theta_.size())),
      colours_(grids_of(read(file, "rgb", {turn_count(file), theta_.size(), 3, 0, 0}),
                        3 * theta_.size())) {}

RglWarp::Place RglBrdf::place(double theta) const {
  const auto after = std::upper_bound(theta_.begin(), theta_.end(), static_cast<float>(theta));
  if (after == theta_.begin()) return {0, 0};
  if (after == theta_.end()) return {theta_.size() - 2, 1};
  const auto lower = static_cast<std::size_t>(after - theta_.begin()) - 1;
  const double begin = theta_[lower], end = theta_[lower + 1];
  return {lower, std::clamp((theta - begin) / (end - begin), 0.0, 1.0)};
}

std::optional<Vec3d> RglBrdf::value(const HalfDifference&, const DirectionPair& pair) const {
  const Vec3d sum = pair.in + pair.out;
  const double theta = std::atan2(std::hypot(pair.in.x, pair.in.y), pair.in.z);
  const double turn = (std::atan2(sum.y, sum.x) - std::atan2(pair.in.y, pair.in.x)) / (2 * kPi);
  // The tables' azimuths begin at −π.
  const SquarePoint half{angle_share(std::atan2(std::hypot(sum.x, sum.y), sum.z)),
                         turn + 0.5 - std::floor(turn + 0.5)};
  const double distribution = ndf_.at(half);
  const double area = sigma_.at({angle_share(theta), 0.5});
  if (!(distribution > 0 && area > 0)) return std::nullopt;
  const RglWarp::Place at = place(theta);
  const SquarePoint uniform = visible_.uniform(at, half);
  const double scale = distribution / (4 * area * std::max(pair.out.z, 1e-6));
  Vec3d rgb;
  for (std::size_t c = 0; c < 3; ++c) {
    const double low = colours_[at.lower * 3 + c].at(uniform);
    const double high = colours_[at.lower * 3 + 3 + c].at(uniform);
    rgb[static_cast<int>(c)] = scale * (low + (high - low) * at.share);
  }
  if (!is_finite(rgb)) return std::nullopt;
  return rgb;
}

}  // namespace rimlight
