#include "core/curves/curve_light.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/bake/texel_quadrature.h"
#include "core/base/check.h"
#include "core/basis/cube_map.h"
#include "core/transport/curve_receivers.h"

namespace rimlight {
namespace {

constexpr std::size_t kVector = LightPoints::kVector;
static_assert(LightPoints::kQuarters == kQuarters);

/// Texels by blocks of side × side, block by block in the order of texels.
std::vector<std::uint32_t> texels_by_blocks(std::size_t size, std::size_t side) {
  std::vector<std::uint32_t> order;
  for (std::size_t row = 0; row < cube::kFaces * size; row += side) {
    for (std::size_t column = 0; column < size; column += side) {
      for (std::size_t i = 0; i < side * side; ++i) {
        order.push_back(static_cast<std::uint32_t>((row + i / side) * size + column + i % side));
      }
    }
  }
  return order;
}

LightPoints make_points(std::size_t count) {
  LightPoints points;
  for (auto& quarter : points.quarters) {
    const std::size_t padded = (count + kVector - 1) / kVector * kVector;
    quarter.x.assign(padded, 0);
    quarter.y.assign(padded, 0);
    quarter.z.assign(padded, 1);
    quarter.solid_angle.assign(padded, 0);
  }
  points.cones.resize(points.size() / kVector);
  return points;
}

Vec3f direction(const LightPoints::Quarter& quarter, std::size_t point) {
  return {quarter.x[point], quarter.y[point], quarter.z[point]};
}

void set(LightPoints& points, std::size_t quarter, std::size_t point, const Vec3f& direction,
         float solid_angle) {
  points.quarters[quarter].x[point] = direction.x;
  points.quarters[quarter].y[point] = direction.y;
  points.quarters[quarter].z[point] = direction.z;
  points.quarters[quarter].solid_angle[point] = solid_angle;
}

/// Cones about what has a solid angle.
void find_cones(LightPoints& points) {
  const auto visit = [&](std::size_t vector, const auto& call) {
    for (const auto& quarter : points.quarters) {
      for (std::size_t i = vector * kVector; i < (vector + 1) * kVector; ++i) {
        if (quarter.solid_angle[i] > 0) call(direction(quarter, i));
      }
    }
  };
  for (std::size_t v = 0; v < points.cones.size(); ++v) {
    Vec3f sum;
    visit(v, [&](const Vec3f& d) { sum += d; });
    // Far apart, as the strongest points may be: a cone of everything.
    if (!(dot(sum, sum) > 1e-4f)) {
      points.cones[v] = {0, 0, 1, 1};
      continue;
    }
    const Vec3f axis = normalized(sum);
    float cosine = 1;
    visit(v, [&](const Vec3f& d) { cosine = std::min(cosine, dot(axis, d)); });
    const float sine =
        cosine > 0 ? std::sqrt(std::max(0.0f, 1 - cosine * cosine)) * 1.001f + 1e-4f : 1;
    points.cones[v] = {axis.x, axis.y, axis.z, std::min(sine, 1.0f)};
  }
}

LightPoints points_of(const TexelQuadrature& texels, std::span<const std::uint32_t> order) {
  LightPoints points = make_points(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t q = 0; q < kQuarters; ++q) {
      const QuadraturePoint& quarter = texels.quarters(order[i])[q];
      set(points, q, i, quarter.direction, quarter.solid_angle);
    }
  }
  find_cones(points);
  return points;
}

PointRadiance make_radiance(std::size_t points) {
  PointRadiance result;
  for (auto& channel : result.radiance) channel.assign(points, 0);
  result.is_lit.assign(points, 0);
  result.lit_vector.assign(points / kVector, 0);
  return result;
}

void set(PointRadiance& radiance, std::size_t point, const Vec3f& value) {
  for (int c = 0; c < 3; ++c) radiance.radiance[static_cast<std::size_t>(c)][point] = value[c];
  const bool is_lit = !(value == Vec3f{});
  radiance.is_lit[point] = is_lit ? 1.0f : 0.0f;
  if (is_lit) radiance.lit_vector[point / kVector] = 1;
}

Vec3f radiance_at(const PointRadiance& radiance, std::size_t point) {
  return {radiance.radiance[0][point], radiance.radiance[1][point], radiance.radiance[2][point]};
}

void clear(PointRadiance& radiance) {
  for (auto& channel : radiance.radiance) std::ranges::fill(channel, 0.0f);
  std::ranges::fill(radiance.is_lit, 0.0f);
  std::ranges::fill(radiance.lit_vector, std::uint8_t{0});
}

/// The coarse point that a point is part of: a block's 8 × 8 are 2 × 2 of 4 × 4 each.
std::size_t coarse_point(std::size_t point) {
  return point / 64 * 4 + point % 64 / 32 * 2 + point % 8 / 4;
}

}  // namespace

CurveSky::CurveSky(int cube_size) : cube_size_(cube_size) {
  constexpr int kSide = SkyVisibilityView::kBlockSide;
  RIMLIGHT_CHECK(cube_size >= kSide && cube_size % kSide == 0);
  const auto size = static_cast<std::size_t>(cube_size);
  texel_of_point_ = texels_by_blocks(size, kSide);
  point_of_texel_.resize(texel_of_point_.size());
  for (std::size_t i = 0; i < texel_of_point_.size(); ++i) {
    point_of_texel_[texel_of_point_[i]] = static_cast<std::uint32_t>(i);
    solid_angles_.push_back(
        static_cast<float>(cube::texel_solid_angle(texel_of_point_[i], cube_size)));
  }
  texels_ = points_of(TexelQuadrature(cube_size), texel_of_point_);
  coarse_ = points_of(TexelQuadrature(cube_size / 4), texels_by_blocks(size / 4, 2));
}

CurveLight::CurveLight(const CurveSky& sky, const CubeLight& light, std::size_t strongest)
    : sky_(&sky),
      texels_(make_radiance(sky.texels().size())),
      coarse_(make_radiance(sky.coarse().size())),
      strongest_points_(make_points(strongest)),
      strongest_indices_(strongest),
      order_(sky.texel_of_point().size()),
      means_(order_.size() / 16) {
  RIMLIGHT_CHECK(strongest <= order_.size());
  strongest_ = make_radiance(strongest_points_.size());
  set(light);
}

void CurveLight::set(const CubeLight& light) {
  RIMLIGHT_CHECK_EQ(light.size, sky_->cube_size());
  for (PointRadiance* const each : {&texels_, &coarse_, &strongest_}) clear(*each);
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const Vec3f value = light.at(sky_->texel_of_point()[i]);
    RIMLIGHT_CHECK(is_finite(value));
    rimlight::set(texels_, i, value);
  }
  find_strongest();
  take_strongest();
  find_means();
}

/// The points of most radiance · solid angle, ascending; equals by index.
void CurveLight::find_strongest() {
  std::iota(order_.begin(), order_.end(), 0u);
  const auto energy = [&](std::uint32_t i) {
    const Vec3f rgb = radiance_at(texels_, i);
    return (rgb.x + rgb.y + rgb.z) * sky_->solid_angles()[i];
  };
  const auto middle = order_.begin() + static_cast<std::ptrdiff_t>(strongest_indices_.size());
  if (middle != order_.end()) {
    std::ranges::nth_element(order_, middle, [&](std::uint32_t a, std::uint32_t b) {
      const float of_a = energy(a), of_b = energy(b);
      return of_a != of_b ? of_a > of_b : a < b;
    });
  }
  std::copy(order_.begin(), middle, strongest_indices_.begin());
  std::ranges::sort(strongest_indices_);
}

void CurveLight::take_strongest() {
  for (std::size_t i = 0; i < strongest_indices_.size(); ++i) {
    const std::uint32_t point = strongest_indices_[i];
    for (std::size_t q = 0; q < kQuarters; ++q) {
      const auto& quarter = sky_->texels().quarters[q];
      rimlight::set(strongest_points_, q, i, direction(quarter, point), quarter.solid_angle[point]);
    }
    rimlight::set(strongest_, i, radiance_at(texels_, point));
  }
  find_cones(strongest_points_);
}

/// Of all but the strongest.
void CurveLight::find_means() {
  std::ranges::fill(means_, Mean{});
  auto strongest = strongest_indices_.begin();
  for (std::uint32_t i = 0; i < order_.size(); ++i) {
    Mean& mean = means_[coarse_point(i)];
    mean.solid_angle += sky_->solid_angles()[i];
    if (strongest != strongest_indices_.end() && *strongest == i) {
      ++strongest;
    } else {
      mean.sum += Vec3d(radiance_at(texels_, i)) * sky_->solid_angles()[i];
    }
  }
  for (std::size_t i = 0; i < means_.size(); ++i) {
    rimlight::set(coarse_, i, Vec3f(means_[i].sum / means_[i].solid_angle));
  }
}

}  // namespace rimlight
