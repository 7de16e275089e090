#include "tests/core/curves/curve_cases.h"

#include <algorithm>
#include <cmath>

#include "core/bake/texel_quadrature.h"
#include "core/material/half_difference.h"
#include "core/math/random.h"
#include "core/transport/receivers.h"

namespace rimlight {
namespace {

Vec3f random_direction(Random& random) {
  while (true) {
    const Vec3d at{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (dot(at, at) > 0.01 && dot(at, at) < 1) return Vec3f(normalized(at));
  }
}

Vec3f bent(const Vec3f& direction, float by, Random& random) {
  return normalized(direction + random_direction(random) * by);
}

/// A direction above the horizon for which some quarter's middle is mirrored: the centre of a lobe.
Vec3f mirroring(const Vec3f& normal, std::size_t quarter, const TexelQuadrature& texels,
                Random& random) {
  while (true) {
    const Vec3d in(texels.quarters(random.below(texels.count()))[quarter].direction);
    const double cosine = dot(in, Vec3d(normal));
    if (cosine > 0.1) return Vec3f(normalized(Vec3d(normal) * (2 * cosine) - in));
  }
}

CurveSurface random_surface(Random& random, std::uint32_t receiver, std::uint32_t material,
                            const TexelQuadrature& texels) {
  CurveSurface surface;
  surface.receiver = receiver;
  surface.material = material;
  surface.share = static_cast<float>(random.uniform(0.1, 1));
  for (int c = 0; c < 3; ++c) surface.tint[c] = random.uniform_float();
  const Vec3f normal = random_direction(random), tangent = random_direction(random);
  // Every fourth view grazes.
  Vec3f outgoing = random_direction(random);
  if (dot(outgoing, normal) < 0) outgoing = -outgoing;
  if (random.below(4) == 0)
    outgoing = normalized(outgoing - normal * (0.97f * dot(outgoing, normal)));
  for (SurfacePoint& point : surface.points) {
    point.normal = bent(normal, 0.05f, random);
    point.tangent = random.below(8) == 0 ? Vec3f{} : tangent;
    point.geometric_normal = bent(point.normal, 0.1f, random);
    point.outgoing = bent(outgoing, 0.01f, random);
  }
  const std::size_t quarter = random.below(2 * kQuarters);
  if (quarter < kQuarters) {
    SurfacePoint& point = surface.points[quarter];
    point.outgoing = mirroring(point.normal, quarter, texels, random);
  }
  return surface;
}

/// Whole blocks that are seen or not, and some with a border inside.
std::vector<std::uint8_t> random_fifths(Random& random, int cube_size) {
  std::vector<std::uint8_t> fifths(cube::texel_count(cube_size));
  const Vec3d border(random_direction(random));
  const double at = random.uniform(-1, 0.5);
  for (std::size_t i = 0; i < fifths.size(); ++i) {
    const double side = dot(border, cube::texel_direction(i, cube_size)) - at;
    fifths[i] = static_cast<std::uint8_t>(std::clamp(std::floor(3 + 12 * side), 0.0, 5.0));
  }
  return fifths;
}

Vec3d bin_value(const BrdfCurve& curve, double angle) {
  return Vec3d(curve.values[bin_of(curve.axis, angle)]);
}

/// The lobe and what is below it, the albedo tinted.
Vec3d evaluate_tinted(const CurveMaterialState& state, const Vec3f& tint, const Vec3d& in,
                      const Vec3d& out) {
  if (!state.measured) {
    CurvedBrdf curved{state.brdf, state.half_angle, state.difference_angle};
    curved.base.albedo *= tint;
    return evaluate(curved, in, out);
  }
  const HalfDifference angles = half_difference(in, out);
  return rest_at(*state.measured, in, out) * bin_value(*state.half_angle, angles.half) *
         bin_value(*state.difference_angle, angles.difference);
}

void add_cook_torrance(std::vector<CurveCase>& cases) {
  struct Index {
    const char* name;
    Vec3f eta, k, albedo;
  };
  const Index indices[] = {{"glaze", {1.5f, 1.6f, 1.4f}, {}, {0.8f, 0.3f, 0.1f}},
                           {"gold", {0.18f, 0.42f, 1.37f}, {3.42f, 2.35f, 1.77f}, {}},
                           {"corners", {1, 100, 0.05f}, {0, 100, 0}, {}}};
  for (const Index& index : indices) {
    for (const float roughness : {1e-4f, 0.02f, 0.2f, 1.0f}) {
      cases.push_back({std::string(index.name) + " of roughness " + std::to_string(roughness),
                       {"",
                        {.model = BrdfModel::cook_torrance,
                         .albedo = index.albedo,
                         .specular = {1, 0.9f, 0.8f},
                         .roughness = roughness,
                         .eta = index.eta,
                         .k = index.k}}});
    }
  }
}

}  // namespace

CurveScene random_scene(std::vector<CurveMaterial> materials, std::size_t rows, int cube_size,
                        std::uint64_t seed) {
  CurveScene scene(cube_size);
  const TexelQuadrature texels(cube_size);
  Random random(seed);
  for (std::uint32_t m = 0; m < materials.size(); ++m) {
    for (std::uint32_t row = 0; row < rows; ++row) {
      const auto receiver = m * static_cast<std::uint32_t>(kTileReceivers) + 3 * row;
      for (std::uint32_t i = 0; i < (row % 5 == 0 ? 2u : 1u); ++i) {
        scene.surfaces.push_back(random_surface(random, receiver, m, texels));
        scene.visibility.add(random_fifths(random, cube_size));
      }
    }
  }
  scene.materials = std::move(materials);
  return scene;
}

CubeLight random_light(int cube_size, std::uint64_t seed) {
  CubeLight light(cube_size);
  Random random(seed);
  for (std::size_t i = 0; i < light.count(); ++i) {
    const bool is_black = random.below(7) == 0;
    for (int c = 0; c < 3; ++c) {
      light.channel(c)[i] = is_black ? 0 : static_cast<float>(std::exp(random.uniform(-2, 2)));
    }
  }
  const std::size_t sun = random.below(light.count());
  for (int c = 0; c < 3; ++c) light.channel(c)[sun] = 1000;
  return light;
}

FactoredBrdf some_measured() {
  FactoredBrdf brdf;
  for (std::size_t i = 0; i < kCurveBins; ++i) {
    const auto x = static_cast<float>(i) / kCurveBins;
    brdf.half_angle.values[i] = {0.1f + 20 * std::exp(-30 * x), 0.2f + 9 * std::exp(-20 * x),
                                 0.05f + 15 * std::exp(-40 * x)};
    brdf.difference_angle.values[i] = {1 + x, 1 + 2 * x * x, 0.7f + 0.1f * x};
  }
  for (std::size_t i = 0; i < kRestKnots; ++i) {
    const auto x = static_cast<float>(i) / kRestKnots;
    brdf.rest[i] = {1 + x * x, std::exp(-x), 1 + 0.3f * std::sin(9 * x)};
  }
  return brdf;
}

std::vector<CurveCase> curve_cases() {
  std::vector<CurveCase> cases;
  cases.push_back({"lambert", {"", {.albedo = {0.8f, 0.3f, 0.05f}}}});
  add_cook_torrance(cases);
  for (const float exponent : {1.0f, 60.0f, 1e5f}) {
    Brdf brdf{.model = BrdfModel::blinn_phong,
              .albedo = {0.5f, 0.2f, 0},
              .specular = {0.5f, 0.6f, 1},
              .exponent = exponent,
              .exponent_across = 3};
    const std::string name = " of exponent " + std::to_string(exponent);
    cases.push_back({"Blinn–Phong" + name, {"", brdf}});
    brdf.model = BrdfModel::phong;
    cases.push_back({"Phong" + name, {"", brdf}});
    brdf.model = BrdfModel::ashikhmin_shirley;
    cases.push_back({"Ashikhmin–Shirley" + name, {"", brdf}});
  }
  cases.push_back({"Ward",
                   {"",
                    {.model = BrdfModel::ward,
                     .albedo = {0.5f, 0.2f, 0},
                     .specular = {0.5f, 0.6f, 1},
                     .roughness = 0.1f,
                     .roughness_across = 0.5f}}});
  cases.push_back({"measured", {"", {}, some_measured()}});
  return cases;
}

Vec3d reference_row(const CurveReceivers& receivers, const CurvePanel& panel, std::size_t row,
                    const CubeLight& light, const CurveMaterialState& state) {
  const TexelQuadrature texels(light.size);
  std::vector<std::uint8_t> fifths(texels.count());
  Vec3d sum;
  for (auto i = panel.first_surface[row]; i < panel.first_surface[row + 1]; ++i) {
    const CurveSurface& surface = receivers.surfaces[i];
    receivers.visibility.unpack(i, fifths);
    for (std::size_t q = 0; q < kQuarters; ++q) {
      const SurfacePoint& point = surface.points[q];
      const Frame<double> frame(Vec3d(point.normal), Vec3d(point.tangent));
      const Vec3d out = frame.to_local(Vec3d(point.outgoing));
      for (std::size_t t = 0; t < texels.count(); ++t) {
        const QuadraturePoint& quarter = texels.quarters(t)[q];
        const Vec3d in = frame.to_local(Vec3d(quarter.direction));
        const bool is_lit = dot(point.geometric_normal, quarter.direction) > 0 && in.z > 0;
        if (!is_lit || fifths[t] == 0) continue;
        const double weight = in.z * quarter.solid_angle * fifths[t] / 5 * surface.share;
        sum += evaluate_tinted(state, surface.tint, in, out) * Vec3d(light.at(t)) * weight;
      }
    }
  }
  return sum;
}

Vec3d stored_row(const CurveTransport& transport, std::size_t panel, std::size_t row,
                 CurveAxis axis, const CurveCoefficients& curve) {
  const auto numbers = transport.numbers(panel, axis);
  const auto steps = transport.steps(panel, axis);
  Vec3d sum;
  for (int c = 0; c < 3; ++c) {
    const auto channel = static_cast<std::size_t>(c);
    sum[c] = transport.fixed(panel)[channel * kPanelRows + row];
    for (std::size_t k = 0; k < kCurveBins; ++k) {
      const double value = numbers[(k * 3 + channel) * kPanelRows + row];
      sum[c] += value * steps[k * 3 + channel] * curve[k][c];
    }
  }
  return sum;
}

CurveMaterialState baked_state(const CurveMaterial& material) {
  return resolve(material, {}, {}, material.name);
}

PanelCase::PanelCase(const CurveMaterial& material, const CubeLight& light_, std::uint64_t seed)
    : scene(random_scene({material}, kRows, kSize, seed)),
      light(light_),
      curve_light(sky, light, 0),
      transport(scene.receivers()) {}

void PanelCase::rebuild(const CurveMaterialState& state, std::optional<CurveAxis> axis,
                        std::uint64_t version) {
  for (std::size_t panel = 0; panel < transport.panels().size(); ++panel) {
    if (axis) {
      transport.rebuild(panel, curve_light, state, *axis, version);
    } else {
      transport.rebuild_fixed(panel, curve_light, state, version);
    }
  }
}

}  // namespace rimlight
