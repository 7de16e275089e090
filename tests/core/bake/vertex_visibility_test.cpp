// Transport straight from the sky against closed forms.
#include "core/bake/vertex_visibility.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/bake/vertex_mesh.h"
#include "core/base/parallel.h"
#include "core/basis/sh.h"
#include "core/basis/sh_zonal.h"
#include "tests/core/bake/bake_scenes.h"
#include "tests/core/scene/scene_cases.h"
#include "tests/support/reference/spherical_harmonics.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Vec3d kBall{0.4, 3, -0.7};
constexpr double kRadius = 1;

/// A small square that looks up at a ball: rays start from the square only.
struct SquareUnderBall {
  PreparedVertices square;
  RayScene rays = ray_scene_of(prepare_vertices(*scene_of(meshes())).mesh);

  explicit SquareUnderBall(bool highlight) {
    auto scene = scene_of({meshes()[0]});
    if (highlight) {
      scene->materials[0].brdf.model = BrdfModel::phong;
      scene->materials[0].brdf.specular = {0.2f, 0.2f, 0.2f};
    }
    square = prepare_vertices(*scene);
  }

  static std::vector<Mesh> meshes() {
    Mesh square = quad({-0.1f, 0, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f}, 0);
    square.normals.assign(4, {0, 1, 0});
    return {square, test_sphere(Vec3f(kBall), kRadius, 96)};
  }

  const VertexMesh& mesh() const { return square.mesh; }
  VertexVisibility trace(const RaySettings& settings, const ShareDone& done = {}) const {
    return shadowed_visibility(rays, square.mesh, square.highlight_count, settings, done);
  }
};

/// ∫ P_l over [c, 1] = (P_{l−1}(c) − P_{l+1}(c))/(2l + 1).
sh::ZonalLobe cap_lobe(double cosine, int degree) {
  const auto p = sh::legendre(cosine, degree + 1);
  sh::ZonalLobe lobe(static_cast<std::size_t>(degree) + 1);
  for (std::size_t l = 0; l < lobe.size(); ++l) {
    const double n = 2 * static_cast<double>(l) + 1;
    const double integral = l == 0 ? 1 - cosine : (p[l - 1] - p[l + 1]) / n;
    lobe[l] = 2 * kPi * std::sqrt(n / (4 * kPi)) * integral;
  }
  return lobe;
}

/// What the ball hides of the sky, with a weight: by quadrature over its cap, in double.
std::vector<double> hidden(const Vec3d& to_ball, int degree, bool cosine_weighted) {
  const double sine = kRadius / length(to_ball), least = std::sqrt(1 - sine * sine);
  const Frame<double> frame(normalized(to_ball));
  std::vector<double> sums(sh::coefficient_count(degree));
  constexpr int kAcross = 48, kAround = 96;
  for (int i = 0; i < kAcross; ++i) {
    for (int j = 0; j < kAround; ++j) {
      const double z = least + (1 - least) * (i + 0.5) / kAcross, r = std::sqrt(1 - z * z);
      const double phi = 2 * kPi * (j + 0.5) / kAround;
      const Vec3d direction = frame.to_world({r * std::cos(phi), r * std::sin(phi), z});
      const double weight = 2 * kPi * (1 - least) / (kAcross * kAround) *
                            (cosine_weighted ? std::max(0.0, direction.y) : 1);
      for (int l = 0; l <= degree; ++l) {
        for (int m = -l; m <= l; ++m) {
          sums[sh::index(l, m)] += weight * reference::spherical_harmonic(l, m, direction);
        }
      }
    }
  }
  return sums;
}

double rms(std::span<const float> found, const std::vector<double>& expected) {
  double sum = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) sum += std::pow(found[i] - expected[i], 2);
  return std::sqrt(sum / static_cast<double>(expected.size()));
}

TEST(VertexVisibility, AConvexObjectSeesTheWholeSkyExactly) {
  auto scene = scene_of({test_sphere({0.5f, 1, 2}, 1.5f, 16)});
  // Outward: the test sphere's triangles may go either way around.
  for (const Vec3f& p : scene->meshes[0].positions) {
    scene->meshes[0].normals.push_back(Vec3f(normalized(Vec3d(p) - Vec3d(0.5, 1, 2))));
  }
  const PreparedVertices prepared = prepare_vertices(*scene);
  const RayScene rays = ray_scene_of(prepared.mesh);
  const int degree = 10;
  const auto found =
      shadowed_visibility(rays, prepared.mesh, 0, {.degree = degree, .error = 0.01}, {});
  const auto unshadowed = unshadowed_visibility(prepared.mesh, 0, degree);
  EXPECT_EQ(found.irradiance, unshadowed.irradiance);
  const std::size_t count = sh::coefficient_count(degree);
  const auto lobe = sh::clamped_cosine_lobe(degree);
  ASSERT_GT(prepared.mesh.positions.size(), 400u);
  for (std::size_t v = 0; v < prepared.mesh.positions.size(); ++v) {
    EXPECT_EQ(found.blocked[v], 0u);
    const auto expected = sh::turned_lobe(lobe, Vec3d(prepared.mesh.normals[v]));
    EXPECT_LT(rms(std::span(found.irradiance).subspan(v * count, count), expected), 1e-7);
  }
}

TEST(VertexVisibility, UnderABallIsTheHemisphereWithoutACap) {
  const SquareUnderBall scene(true);
  const RaySettings settings{.degree = 8, .error = 0.002, .most_rays = 1 << 16, .seed = 3};
  const auto found = scene.trace(settings);
  const std::size_t count = sh::coefficient_count(settings.degree);
  const auto sky = sh::turned_lobe(
      sh::sampled_lobe([](double c) { return c > 0 ? 1.0 : 0.0; }, settings.degree), {0, 1, 0});
  const auto cosine = sh::turned_lobe(sh::clamped_cosine_lobe(settings.degree), {0, 1, 0});
  for (std::size_t v = 0; v < 4; ++v) {
    const Vec3d to_ball = kBall - Vec3d(scene.mesh().positions[v]);
    const double sine = kRadius / length(to_ball);
    const auto cap =
        sh::turned_lobe(cap_lobe(std::sqrt(1 - sine * sine), settings.degree), to_ball);
    const auto cap_cosine = hidden(to_ball, settings.degree, true);
    std::vector<double> visibility(count), irradiance(count);
    for (std::size_t i = 0; i < count; ++i) {
      visibility[i] = sky[i] - cap[i];
      irradiance[i] = cosine[i] - cap_cosine[i];
    }
    EXPECT_LT(found.error[v], settings.error);
    EXPECT_GT(found.rays[v], 1000u);
    // Five standard errors of an rms over 81 coefficients are far away.
    EXPECT_LT(rms(std::span(found.visibility).subspan(v * count, count), visibility), 0.003);
    EXPECT_LT(rms(std::span(found.irradiance).subspan(v * count, count), irradiance), 0.003);
    EXPECT_GT(rms(std::span(found.visibility).subspan(v * count, count), sky), 0.02);
  }
}

TEST(VertexVisibility, TheErrorIsBelowWhatItClaims) {
  for (const bool highlight : {false, true}) {
    const SquareUnderBall scene(highlight);
    const std::size_t count = sh::coefficient_count(6);
    const auto cosine = sh::turned_lobe(sh::clamped_cosine_lobe(6), {0, 1, 0});
    std::vector<std::vector<double>> expected;
    for (const Vec3f& position : scene.mesh().positions) {
      expected.push_back(cosine);
      const auto cap = hidden(kBall - Vec3d(position), 6, true);
      for (std::size_t i = 0; i < count; ++i) expected.back()[i] -= cap[i];
    }
    double squares = 0, claimed = 0;
    constexpr int kSeeds = 12;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      const RaySettings settings{.degree = 6,
                                 .error = 0.01,
                                 .most_rays = 1 << 16,
                                 .seed = static_cast<std::uint64_t>(seed)};
      const auto found = scene.trace(settings);
      for (std::size_t v = 0; v < 4; ++v) {
        const auto light = std::span(found.irradiance).subspan(v * count, count);
        squares += std::pow(rms(light, expected[v]), 2);
        claimed += std::pow(found.error[v], 2);
        EXPECT_LE(found.error[v], settings.error);
      }
    }
    EXPECT_LT(squares, claimed) << highlight;
    EXPECT_GT(squares, claimed / 50) << "claims that are that far off waste rays";
  }
}

TEST(VertexVisibility, TheCapOnRaysIsKeptAndSaid) {
  const SquareUnderBall scene(false);
  const auto found = scene.trace({.degree = 10, .error = 1e-4, .most_rays = 300, .seed = 1});
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_EQ(found.rays[v], 256u);
    EXPECT_GT(found.error[v], 1e-4f);
  }
}

TEST(VertexVisibility, DoesNotDependOnThreads) {
  const SquareUnderBall scene(true);
  const RaySettings settings{.degree = 5, .error = 0.02};
  std::vector<double> told;
  const auto all = scene.trace(settings, [&](double share) { told.push_back(share); });
  set_thread_count(1);
  const auto one = scene.trace(settings);
  set_thread_count(0);
  EXPECT_EQ(all.irradiance, one.irradiance);
  EXPECT_EQ(all.visibility, one.visibility);
  EXPECT_EQ(all.error, one.error);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_EQ(told.back(), 1);
}

}  // namespace
}  // namespace rimlight
