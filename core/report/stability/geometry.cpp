// Geometry at the ends of what floats can place.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/bake/vertex_sh_bake.h"
#include "core/base/error.h"
#include "core/image/metrics.h"
#include "core/report/stability/cases.h"
#include "core/report/stability/small_scenes.h"
#include "core/scene/mesh_geometry.h"
#include "core/scene/shapes.h"

namespace rimlight::stability {
namespace {

constexpr int kCubeSize = 8;

/// Relative L2 between the pictures of two scenes; of another size, infinity.
double distance(const std::shared_ptr<const Scene>& scene,
                const std::shared_ptr<const Scene>& reference) {
  const CubeLight light = random_sky(kCubeSize);
  const auto picture = picture_of(scene, light), expected = picture_of(reference, light);
  if (picture.size() != expected.size()) return std::numeric_limits<double>::infinity();
  return relative_l2(picture, expected);
}

StabilityMeasure picture_at_scale(double scale, const StabilityTrial& trial) {
  const auto scene = still_life(scale);
  if (trial.broken) scene->camera.position.x += 0.05 * scale;
  return {distance(scene, still_life())};
}

std::vector<float> irradiance_of(const Scene& scene) {
  return calculate_vertices(scene, prepare_vertices(scene), {}).transport.irradiance.at(0);
}

StabilityMeasure vertices_at_scale(double scale, const StabilityTrial& trial) {
  const auto scene = still_life(scale);
  if (trial.broken) scale_by(scene->meshes[1], 1.1);
  const auto values = irradiance_of(*scene), expected = irradiance_of(*still_life());
  if (values.size() != expected.size()) return {std::numeric_limits<double>::infinity()};
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    difference += std::pow(double{values[i]} - double{expected[i]}, 2);
    size += std::pow(double{expected[i]}, 2);
  }
  return {std::sqrt(difference / size)};
}

/// Every surface twice, at the same place.
StabilityMeasure coincident(const StabilityTrial& trial) {
  const auto scene = still_life();
  for (std::size_t i = 0; i < 3; ++i) scene->meshes.push_back(scene->meshes[i]);
  if (trial.broken) scale_by(scene->meshes.back(), 1.05);
  return {distance(scene, still_life())};
}

StabilityMeasure coincident_vertices(const StabilityTrial& trial) {
  const auto scene = still_life();
  for (std::size_t i = 0; i < 3; ++i) scene->meshes.push_back(scene->meshes[i]);
  if (trial.broken) scale_by(scene->meshes.back(), 1.05);
  const auto mean = [](const std::vector<float>& values) {
    double sum = 0;
    for (std::size_t i = 0; i < values.size(); i += sh::coefficient_count(4)) {
      sum += double{values[i]};
    }
    return sum / static_cast<double>(values.size());
  };
  return {std::abs(mean(irradiance_of(*scene)) / mean(irradiance_of(*still_life())) - 1)};
}

/// A plane of needles: strips `width` wide, of two triangles each.
Mesh needles(double size, double width, int count) {
  Mesh mesh;
  mesh.name = "needles";
  const auto half = static_cast<float>(size / 2);
  for (int i = 0; i <= count; ++i) {
    // A wide strip, then a narrow one.
    const double pair = size / (count / 2);
    const double x = -size / 2 + pair * (i / 2) + (i % 2 == 0 ? 0 : pair - width);
    for (const float z : {-half, half}) mesh.positions.push_back({static_cast<float>(x), 0, z});
  }
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i) {
    const std::uint32_t first = 2 * i;
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first + 1, first + 3, first + 2});
  }
  return mesh;
}

StabilityMeasure needle_triangles(const StabilityTrial& trial) {
  double worst = 0;
  std::string note;
  for (const double width : {1e-3, 1e-5, 3e-6}) {
    const auto scene = still_life();
    scene->meshes[0] = needles(6, width, 200);
    note += std::to_string(drop_degenerate_triangles(scene->meshes[0])) + " dropped ";
    if (trial.broken) scene->meshes[0].triangles.resize(200);
    worst = std::max(worst, distance(scene, still_life()));
  }
  return {worst, note};
}

/// How many triangles without area stay, and how many vertices' transport is no number.
StabilityMeasure triangles_without_area(const StabilityTrial& trial) {
  const auto scene = still_life();
  Mesh& plane = scene->meshes[0];
  const std::size_t before = plane.triangles.size();
  plane.triangles.push_back({0, 0, 1});
  plane.triangles.push_back({1, 1, 1});
  plane.positions.push_back(plane.positions[0]);
  plane.normals.push_back(plane.normals[0]);
  plane.texture_coordinates.push_back({});
  const auto last = static_cast<std::uint32_t>(plane.positions.size() - 1);
  plane.triangles.push_back({0, last, 1});
  if (!trial.broken) drop_degenerate_triangles(plane);
  double faults = static_cast<double>(plane.triangles.size() - before);
  for (const float value : irradiance_of(*scene)) faults += std::isfinite(value) ? 0 : 1;
  return {faults};
}

/// Inside a closed box no light arrives; the picture and the vertices are black, and are numbers.
StabilityMeasure camera_inside(const StabilityTrial& trial) {
  const auto scene = still_life();
  scene->meshes = {make_box({2, 2, 2})};
  scene->meshes[0].normals.clear();
  scene->camera.position = {0.1, 0.2, 0.3};
  scene->camera.target = {1, 0.2, 0.3};
  if (trial.broken) scene->meshes[0].triangles.resize(scene->meshes[0].triangles.size() - 2);
  const auto picture = picture_of(scene, uniform_sky(kCubeSize));
  double largest = picture.empty() ? std::numeric_limits<double>::infinity() : 0;
  for (const Vec3f& radiance : picture) {
    const double value = max_component(radiance);
    if (!(value <= largest)) largest = value;
  }
  return {largest, std::to_string(picture.size()) + " pixels"};
}

}  // namespace

std::vector<StabilityCase> geometry_cases() {
  using enum BoundKind;
  const std::string part = "geometry";
  const std::string same =
      "the same rays, but for those that pass an edge within a rounding error: one in 10⁴";
  const auto picture = [](double scale) {
    return [scale](const StabilityTrial& trial) { return picture_at_scale(scale, trial); };
  };
  const auto vertices = [](double scale) {
    return [scale](const StabilityTrial& trial) { return vertices_at_scale(scale, trial); };
  };
  const std::string of_picture = "relative L2 of the picture against that at scale 1";
  const std::string of_vertices = "relative L2 of vertices' transport against that at scale 1";
  return {
      {"picture-at-1e-6", part, of_picture, at_most, 0.01, same, picture(1e-6)},
      {"picture-at-1e6", part, of_picture, at_most, 0.01, same, picture(1e6)},
      {"vertices-at-1e-6", part, of_vertices, at_most, 0.01, same, vertices(1e-6)},
      {"vertices-at-1e6", part, of_vertices, at_most, 0.01, same, vertices(1e6)},
      {"coincident-surfaces", part, "relative L2 of the picture with every surface there twice",
       at_most, 0.01, "the first of two hits at one place may be either; " + same, coincident},
      {"coincident-vertices", part,
       "relative difference of mean irradiance with every surface twice", at_most, 0.02,
       "rays start off the surface by what rounding asks for; 1 % is the rays' error",
       coincident_vertices},
      {"needle-triangles", part,
       "relative L2 of the picture with a plane of needles, 6 by 1e-3 … 3e-6", at_most, 0.01, same,
       needle_triangles},
      {"triangles-without-area", part,
       "those that stay, and numbers of the vertices' transport that are none", at_most, 0,
       "heights below 1e-6 of the longest side are dropped", triangles_without_area},
      {"camera-inside-a-box", part, "largest radiance of the picture", at_most, 0,
       "no ray leaves a closed box", camera_inside},
  };
}

}  // namespace rimlight::stability
