#include "core/bake/direct_transport.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/bake/surface_groups.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

constexpr int kQuadrature = 4;      // 2×2 points in a texel
constexpr int kMoreShadowRays = 4;  // where neighbouring texels disagree

/// A direction inside a texel and the solid angle that it stands for.
struct QuadraturePoint {
  Vec3f direction;
  float solid_angle = 0;
};

/// A hit of a surface, ready to evaluate.
struct Responder {
  const SurfaceHit* hit = nullptr;
  Frame<float> frame{Vec3f{0, 0, 1}};
  Vec3f out;  // local
};

/// One surface's response and shadow rays, texel by texel; reused between pixels of a thread.
struct Workspace {
  std::vector<PixelSurface> surfaces;
  std::vector<std::uint32_t> texels;    // those that the surface can see
  std::vector<Vec3f> response;          // beside texels
  std::vector<std::int8_t> first_seen;  // per texel of the cube: −1 not traced, else 0 or 1
  std::vector<float> seen;              // beside texels: sum over rays
  std::vector<std::uint32_t> refined;   // positions in texels
  std::vector<Ray> rays;
  std::vector<std::uint8_t> visible;
};

bool above(const SurfaceHit& hit, const Vec3f& direction) {
  return dot(hit.geometric_normal, direction) > 0 && dot(hit.shading_normal, direction) > 0;
}

}  // namespace

struct DirectTransport::Tables {
  int size;
  std::vector<std::array<QuadraturePoint, kQuadrature>> points;  // [texel]
  std::vector<Vec3f> middle;                                     // [texel]
  float half_diagonal = 0;  // of the largest texel, as the sine of its angle

  explicit Tables(int size_) : size(size_) {
    const std::size_t count = cube::texel_count(size);
    points.resize(count);
    middle.resize(count);
    half_diagonal = static_cast<float>(std::sqrt(2.0) / size);
    for (std::size_t texel = 0; texel < count; ++texel) fill(texel);
  }

  void fill(std::size_t texel) {
    middle[texel] = Vec3f(cube::texel_direction(texel, size));
    // The texels of a cube map of twice the size are the quarters of this one's.
    const auto side = static_cast<std::size_t>(size);
    const std::size_t face = texel / (side * side);
    const std::size_t row = texel / side % side;
    const std::size_t column = texel % side;
    for (std::size_t quarter = 0; quarter < kQuadrature; ++quarter) {
      const std::size_t fine =
          (face * 2 * side + 2 * row + quarter / 2) * 2 * side + 2 * column + quarter % 2;
      points[texel][quarter] = {Vec3f(cube::texel_direction(fine, 2 * size)),
                                static_cast<float>(cube::texel_solid_angle(fine, 2 * size))};
    }
  }

  /// A uniformly jittered direction inside a texel.
  Vec3f jittered(std::size_t texel, Random& random) const {
    const auto side = static_cast<std::size_t>(size);
    const cube::FaceAxes& axes = cube::face_axes(static_cast<int>(texel / (side * side)));
    const auto column = static_cast<double>(texel % side);
    const auto row = static_cast<double>(texel / side % side);
    const double x = 2 * (column + random.uniform()) / size - 1;
    const double y = 2 * (row + random.uniform()) / size - 1;
    return normalized(Vec3f(axes.axis + axes.right * x + axes.up * y));
  }
};

namespace {

/// Four hits spread over the surface stand for all when its response is evaluated.
std::array<Responder, kQuadrature> responders(const PixelSurface& surface) {
  std::array<Responder, kQuadrature> result;
  for (std::size_t i = 0; i < kQuadrature; ++i) {
    const std::size_t pick = (2 * i + 1) * surface.hits.size() / (2 * kQuadrature);
    result[i].hit = surface.hits[pick];
    result[i].frame = Frame<float>(surface.hits[pick]->shading_normal);
    result[i].out = result[i].frame.to_local(surface.outgoing[pick]);
  }
  return result;
}

Vec3f respond(const PixelSurface& surface, const Responder& responder,
              const QuadraturePoint& point) {
  if (!above(*responder.hit, point.direction)) return {};
  const float cosine = dot(responder.hit->shading_normal, point.direction);
  if (surface.brdf.model == BrdfModel::lambert) {
    return surface.brdf.albedo * (std::numbers::inv_pi_v<float> * cosine * point.solid_angle);
  }
  const Vec3f in = responder.frame.to_local(point.direction);
  return evaluate(surface.brdf, in, responder.out) * (cosine * point.solid_angle);
}

/// A shadow ray from a random hit of the surface to a jittered direction that it can see; up to a
/// few tries where the texel straddles the horizon, then the middle of the quarter it sees best.
Ray shadow_ray(const PixelSurface& surface, const std::array<QuadraturePoint, kQuadrature>& points,
               const auto& jittered, Random& random) {
  constexpr int kTries = 4;
  const SurfaceHit& hit = *surface.hits[random.below(surface.hits.size())];
  for (int i = 0; i < kTries; ++i) {
    const Vec3f direction = jittered(random);
    if (above(hit, direction)) return {RayScene::ray_origin(hit, direction), direction};
  }
  const auto best =
      std::max_element(points.begin(), points.end(), [&](const auto& a, const auto& b) {
        return dot(hit.shading_normal, a.direction) < dot(hit.shading_normal, b.direction);
      });
  return {RayScene::ray_origin(hit, best->direction), best->direction};
}

/// Whether the four neighbours on the face that were traced disagree among themselves.
bool neighbours_disagree(const std::vector<std::int8_t>& seen, std::size_t texel, int size) {
  const auto side = static_cast<std::size_t>(size);
  const std::size_t column = texel % side;
  const std::size_t row = texel / side % side;
  bool any_lit = false;
  bool any_dark = false;
  const auto look = [&](bool inside, std::size_t neighbour) {
    if (!inside) return;
    any_lit |= seen[neighbour] == 1;
    any_dark |= seen[neighbour] == 0;
  };
  look(column > 0, texel - 1);
  look(column + 1 < side, texel + 1);
  look(row > 0, texel - side);
  look(row + 1 < side, texel + side);
  return any_lit && any_dark;
}

}  // namespace

DirectTransport::DirectTransport(const RayScene& scene, int cube_size)
    : scene_(scene), tables_(std::make_unique<Tables>(cube_size)) {}

DirectTransport::~DirectTransport() = default;

namespace {

/// The surface's response to every texel that it can see.
template <typename Tables>
void find_response(const PixelSurface& surface, const Tables& tables, Workspace& work) {
  work.texels.clear();
  work.response.clear();
  const auto some = responders(surface);
  for (std::size_t texel = 0; texel < tables.points.size(); ++texel) {
    const bool sees = std::any_of(some.begin(), some.end(), [&](const Responder& one) {
      return dot(one.hit->shading_normal, tables.middle[texel]) > -tables.half_diagonal;
    });
    if (!sees) continue;
    Vec3f sum;
    for (std::size_t i = 0; i < kQuadrature; ++i) {
      sum += respond(surface, some[i], tables.points[texel][i]);
    }
    if (!(max_component(sum) > 0)) continue;
    work.texels.push_back(static_cast<std::uint32_t>(texel));
    work.response.push_back(sum * surface.share);
  }
}

/// First one shadow ray a texel, then more where the neighbours disagree.
template <typename Tables>
void find_visibility(const RayScene& scene, const PixelSurface& surface, const Tables& tables,
                     Random& random, Workspace& work) {
  const auto cast = [&](std::uint32_t texel) {
    work.rays.push_back(shadow_ray(
        surface, tables.points[texel],
        [&](Random& source) { return tables.jittered(texel, source); }, random));
  };
  work.rays.clear();
  for (const std::uint32_t texel : work.texels) cast(texel);
  work.visible.resize(work.rays.size());
  scene.visible(work.rays, {}, work.visible);

  work.first_seen.assign(tables.points.size(), -1);
  work.seen.resize(work.texels.size());
  for (std::size_t i = 0; i < work.texels.size(); ++i) {
    work.first_seen[work.texels[i]] = static_cast<std::int8_t>(work.visible[i]);
    work.seen[i] = work.visible[i];
  }
  work.rays.clear();
  work.refined.clear();
  for (std::size_t i = 0; i < work.texels.size(); ++i) {
    if (!neighbours_disagree(work.first_seen, work.texels[i], tables.size)) continue;
    work.refined.push_back(static_cast<std::uint32_t>(i));
    for (int ray = 0; ray < kMoreShadowRays; ++ray) cast(work.texels[i]);
  }
  work.visible.resize(work.rays.size());
  scene.visible(work.rays, {}, work.visible);
  for (std::size_t i = 0; i < work.refined.size(); ++i) {
    float& seen = work.seen[work.refined[i]];
    for (int ray = 0; ray < kMoreShadowRays; ++ray) {
      seen += work.visible[i * kMoreShadowRays + static_cast<std::size_t>(ray)];
    }
    seen /= 1 + kMoreShadowRays;
  }
}

}  // namespace

void DirectTransport::add(const GroupSamples& samples, std::uint64_t seed, GroupRows& rows) const {
  thread_local Workspace work;
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    Random random(seed, lane);
    find_surfaces(samples, lane, work.surfaces);
    for (const PixelSurface& surface : work.surfaces) {
      find_response(surface, *tables_, work);
      find_visibility(scene_, surface, *tables_, random, work);
      for (std::size_t i = 0; i < work.texels.size(); ++i) {
        if (work.seen[i] == 0) continue;
        float* const row = rows.row(work.texels[i]);
        const Vec3f value = work.response[i] * work.seen[i];
        for (int c = 0; c < 3; ++c)
          row[static_cast<std::size_t>(c) * kGroupLanes + lane] += value[c];
      }
    }
  }
}

}  // namespace rimlight
