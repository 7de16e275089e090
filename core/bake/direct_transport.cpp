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

/// Whether a texel's first shadow ray escaped. Untraced: the texel is below the horizon.
enum class Seen : std::uint8_t { untraced, dark, lit, mixed };

/// One surface of one pixel: its response to the texels that it can see, and what its rays found.
struct SurfaceWork {
  PixelSurface surface;
  std::size_t lane = 0;
  std::vector<std::uint32_t> texels;
  std::vector<Vec3f> response;    // beside texels
  std::vector<float> visibility;  // beside texels
};

/// What a thread keeps between groups.
struct Workspace {
  std::vector<PixelSurface> found;
  std::vector<SurfaceWork> surfaces;
  std::size_t surface_count = 0;
  std::array<std::vector<Seen>, kGroupLanes> seen;  // [lane][texel], over the lane's surfaces
  std::vector<Ray> rays;
  std::vector<std::uint8_t> visible;
  std::vector<std::uint32_t> refined;  // positions in a surface's texels
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

  /// The direction at (u, v) in [0, 1)² of a texel.
  Vec3f inside(std::size_t texel, const Sample2& at) const {
    const auto side = static_cast<std::size_t>(size);
    const cube::FaceAxes& axes = cube::face_axes(static_cast<int>(texel / (side * side)));
    const auto column = static_cast<double>(texel % side);
    const auto row = static_cast<double>(texel / side % side);
    const double x = 2 * (column + at.u) / size - 1;
    const double y = 2 * (row + at.v) / size - 1;
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

/// The surface's response to every texel that it can see.
template <typename Tables>
void find_response(SurfaceWork& work, const Tables& tables) {
  work.texels.clear();
  work.response.clear();
  const auto some = responders(work.surface);
  for (std::size_t texel = 0; texel < tables.points.size(); ++texel) {
    const bool sees = std::any_of(some.begin(), some.end(), [&](const Responder& one) {
      return dot(one.hit->shading_normal, tables.middle[texel]) > -tables.half_diagonal;
    });
    if (!sees) continue;
    Vec3f sum;
    for (std::size_t i = 0; i < kQuadrature; ++i) {
      sum += respond(work.surface, some[i], tables.points[texel][i]);
    }
    if (!(max_component(sum) > 0)) continue;
    work.texels.push_back(static_cast<std::uint32_t>(texel));
    work.response.push_back(sum * work.surface.share);
  }
}

/// The shadow rays of one texel of one surface: ray i starts at the i-th of the surface's hits and
/// goes to the i-th point of an R2 sequence, both from a random begin, so that few rays cover pixel
/// and texel evenly.
template <typename Tables>
class TexelRays {
 public:
  TexelRays(const PixelSurface& surface, const Tables& tables, std::uint32_t texel,
            std::uint64_t seed)
      : surface_(surface), tables_(tables), texel_(texel) {
    Random random(seed, texel);
    shift_ = random_sample(random);
    first_hit_ = random.below(surface.hits.size());
  }

  Ray ray(int i) const {
    // An odd stride visits the hits far apart first; all of them in the end.
    constexpr std::size_t kHitStride = 7;
    const std::size_t count = surface_.hits.size();
    const SurfaceHit& hit =
        *surface_.hits[(first_hit_ + kHitStride * static_cast<std::size_t>(i)) % count];
    const Vec3f direction = tables_.inside(texel_, r2_point(shift_, i));
    if (above(hit, direction)) return {RayScene::ray_origin(hit, direction), direction};
    // The texel straddles the horizon: the middle of the quarter that the hit sees best.
    const auto& quarters = tables_.points[texel_];
    const auto best =
        std::max_element(quarters.begin(), quarters.end(), [&hit](const auto& a, const auto& b) {
          return dot(hit.shading_normal, a.direction) < dot(hit.shading_normal, b.direction);
        });
    return {RayScene::ray_origin(hit, best->direction), best->direction};
  }

 private:
  const PixelSurface& surface_;
  const Tables& tables_;
  std::uint32_t texel_;
  Sample2 shift_;
  std::size_t first_hit_;
};

/// The place of a lane in its group, and back: PixelLayout's order of blocks of 4×2.
struct LanePlace {
  int x, y;
};
LanePlace place_of(std::size_t lane) {
  const PixelLayout::Pixel pixel =
      PixelLayout{PixelLayout::kTileSide, PixelLayout::kTileSide}.pixel(lane);
  return {pixel.x, pixel.y};
}
std::size_t lane_at(int x, int y) {
  return PixelLayout{PixelLayout::kTileSide, PixelLayout::kTileSide}.receiver(x, y);
}

/// The lanes around each lane of a group.
std::array<std::vector<std::size_t>, kGroupLanes> lanes_around() {
  std::array<std::vector<std::size_t>, kGroupLanes> result;
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    const LanePlace at = place_of(lane);
    for (int y = std::max(at.y - 1, 0); y <= std::min(at.y + 1, PixelLayout::kGroupSide - 1); ++y) {
      for (int x = std::max(at.x - 1, 0); x <= std::min(at.x + 1, PixelLayout::kGroupSide - 1);
           ++x) {
        if (lane_at(x, y) != lane) result[lane].push_back(lane_at(x, y));
      }
    }
  }
  return result;
}

/// Whether first rays around (lane, texel) disagree: those of the eight texels around it on its
/// face, and of the same texel in the eight pixels around it. Its own ray has no say.
bool surroundings_disagree(const Workspace& work, std::size_t lane, std::size_t texel, int size) {
  static const auto kAround = lanes_around();
  bool any_lit = false;
  bool any_dark = false;
  const auto look = [&](Seen seen) {
    any_lit |= seen == Seen::lit || seen == Seen::mixed;
    any_dark |= seen == Seen::dark || seen == Seen::mixed;
  };
  const int column = static_cast<int>(texel) % size;
  const int row = static_cast<int>(texel) / size % size;
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, size - 1); ++y) {
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, size - 1); ++x) {
      if (x == column && y == row) continue;
      look(work.seen[lane][static_cast<std::size_t>(static_cast<int>(texel) + (y - row) * size + x -
                                                    column)]);
    }
  }
  for (const std::size_t other : kAround[lane]) look(work.seen[other][texel]);
  return any_lit && any_dark;
}

/// Finds every lane's surfaces and their responses.
template <typename Tables>
void find_responses(const GroupSamples& samples, const Tables& tables, Workspace& work) {
  work.surface_count = 0;
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    find_surfaces(samples, lane, work.found);
    for (PixelSurface& surface : work.found) {
      if (work.surface_count == work.surfaces.size()) work.surfaces.emplace_back();
      SurfaceWork& one = work.surfaces[work.surface_count++];
      std::swap(one.surface, surface);
      one.lane = lane;
      find_response(one, tables);
    }
  }
}

/// One shadow ray to each texel of each surface.
template <typename Tables>
void cast_first_rays(const RayScene& scene, const Tables& tables, std::uint64_t seed,
                     Workspace& work) {
  for (auto& seen : work.seen) seen.assign(tables.points.size(), Seen::untraced);
  for (std::size_t s = 0; s < work.surface_count; ++s) {
    SurfaceWork& one = work.surfaces[s];
    work.rays.clear();
    for (const std::uint32_t texel : one.texels) {
      work.rays.push_back(TexelRays(one.surface, tables, texel, mix_bits(seed + s)).ray(0));
    }
    work.visible.resize(work.rays.size());
    scene.visible(work.rays, {}, work.visible);
    one.visibility.resize(one.texels.size());
    for (std::size_t i = 0; i < one.texels.size(); ++i) {
      one.visibility[i] = work.visible[i];
      const Seen now = work.visible[i] != 0 ? Seen::lit : Seen::dark;
      Seen& seen = work.seen[one.lane][one.texels[i]];
      seen = seen == Seen::untraced || seen == now ? now : Seen::mixed;
    }
  }
}

/// More shadow rays where the surroundings disagree.
template <typename Tables>
void refine(const RayScene& scene, const Tables& tables, std::uint64_t seed, Workspace& work) {
  for (std::size_t s = 0; s < work.surface_count; ++s) {
    SurfaceWork& one = work.surfaces[s];
    work.rays.clear();
    work.refined.clear();
    for (std::size_t i = 0; i < one.texels.size(); ++i) {
      if (!surroundings_disagree(work, one.lane, one.texels[i], tables.size)) continue;
      work.refined.push_back(static_cast<std::uint32_t>(i));
      const TexelRays rays(one.surface, tables, one.texels[i], mix_bits(seed + s));
      for (int ray = 1; ray <= kMoreShadowRays; ++ray) work.rays.push_back(rays.ray(ray));
    }
    work.visible.resize(work.rays.size());
    scene.visible(work.rays, {}, work.visible);
    for (std::size_t i = 0; i < work.refined.size(); ++i) {
      float& visibility = one.visibility[work.refined[i]];
      for (std::size_t ray = 0; ray < kMoreShadowRays; ++ray) {
        visibility += work.visible[i * kMoreShadowRays + ray];
      }
      visibility /= 1 + kMoreShadowRays;
    }
  }
}

}  // namespace

DirectTransport::DirectTransport(const RayScene& scene, int cube_size)
    : scene_(scene), tables_(std::make_unique<Tables>(cube_size)) {}

DirectTransport::~DirectTransport() = default;

void DirectTransport::add(const GroupSamples& samples, std::uint64_t seed, GroupRows& rows) const {
  thread_local Workspace work;
  find_responses(samples, *tables_, work);
  cast_first_rays(scene_, *tables_, seed, work);
  refine(scene_, *tables_, seed, work);
  for (std::size_t s = 0; s < work.surface_count; ++s) {
    const SurfaceWork& one = work.surfaces[s];
    for (std::size_t i = 0; i < one.texels.size(); ++i) {
      if (one.visibility[i] == 0) continue;
      float* const row = rows.row(one.texels[i]);
      const Vec3f value = one.response[i] * one.visibility[i];
      for (int c = 0; c < 3; ++c) {
        row[static_cast<std::size_t>(c) * kGroupLanes + one.lane] += value[c];
      }
    }
  }
}

}  // namespace rimlight
