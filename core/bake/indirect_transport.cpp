#include "core/bake/indirect_transport.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/bake/lane_kernel.h"
#include "core/bake/shared_layer.h"

namespace rimlight {
namespace {

/// A second point on a Lambert surface sends shadow rays to one in so many coarse texels, a later
/// one to one in so many: about 50 and 12 rays at 8×8 texels a face.
constexpr std::uint64_t kFirstCellPart = 4;
constexpr std::uint64_t kLaterCellPart = 16;

/// How many more shadow rays a glossy point gets that is seen by glossy surfaces only.
constexpr int kSharpFactor = 8;

/// A path that goes on from a shared point: its last surface point, and what it carries.
struct Path {
  std::size_t point = 0;  // of the layer: its weights
  SurfaceHit hit;
  Vec3f out;                  // towards the previous point, world
  Vec3f throughput{1, 1, 1};  // from hit back to the shared point
  bool first = true;          // hit is the shared point itself
  /// Every surface from the viewers to here is glossy. They look at few points, so that each must
  /// be known well: a small bright light that one point finds and the next misses would show.
  bool sharp = false;
};

/// A shadow ray's deposit when it escapes.
struct Deposit {
  std::size_t path = 0;
  Vec3f direction;
  Vec3f diffuse;      // goes to the coarse texels
  Vec3f glossy;       // goes to the fine ones
  float share = 1;    // of the point's estimate
  float density = 0;  // of the direction where viewers share it, else 0
};

struct Workspace {
  SharedLayer layer;
  std::vector<Path> paths;
  std::vector<Deposit> deposits;
  std::vector<Ray> rays;
  std::vector<std::uint8_t> visible;
  AlignedVector<float> coarse;  // [coarse texel][3][64]
  AlignedVector<float> diffuse_weights = AlignedVector<float>(kRowLanes);
  AlignedVector<float> glossy_weights = AlignedVector<float>(kRowLanes);
};

/// A shared point reflects towards 64 viewers at once. A Lambert surface does so alike; any other
/// is evaluated viewer by viewer.
bool reflects_alike(const Path& path) {
  return !path.first || path.hit.brdf.model == BrdfModel::lambert;
}

/// The direction from a shared point towards a viewer.
Vec3f towards(const SharedLayer::Viewer& viewer, const SurfaceHit& hit) {
  return normalized(viewer.hit->position - hit.position);
}

class Gatherer {
 public:
  Gatherer(const RayScene& scene, const IndirectSettings& settings, GroupRows& rows, Random& random,
           Workspace& work)
      : scene_(scene), settings_(settings), rows_(rows), random_(random), work_(work) {}

  void run(const GroupSamples& samples) {
    work_.coarse.assign(cube::texel_count(settings_.coarse_size) * kRowLanes, 0.0f);
    const LayerShift shift{random_sample(random_), random_.uniform()};
    for (int ray = 0; ray < samples.rays; ++ray) {
      make_shared_layer(scene_, samples, ray, shift, work_.layer);
      begin_paths();
      for (int bounce = 1; bounce <= settings_.bounces && !work_.paths.empty(); ++bounce) {
        gather(bounce);
        if (bounce < settings_.bounces) extend_paths();
      }
    }
    spread_coarse();
  }

 private:
  void begin_paths() {
    const bool sharp = glossy_viewers();
    work_.paths.clear();
    for (std::size_t p = 0; p < work_.layer.points.size(); ++p) {
      const SharedLayer::Point& point = work_.layer.points[p];
      work_.paths.push_back({p, point.hit, point.out, {1, 1, 1}, true, sharp});
    }
  }

  /// Whether a glossy surface looks at the layer's points.
  bool glossy_viewers() const {
    const auto& viewers = work_.layer.viewers;
    return std::any_of(viewers.begin(), viewers.end(),
                       [](const auto& viewer) { return is_glossy(viewer.hit->brdf); });
  }

  /// Shadow rays from every path's last point, in one stream; those that escape deposit.
  void gather(int bounce) {
    layer_shift_ = random_sample(random_);
    cell_phase_ = random_.below(kLaterCellPart);
    const int rays = bounce == 1 ? settings_.first_rays : settings_.later_rays;
    work_.deposits.clear();
    work_.rays.clear();
    for (std::size_t i = 0; i < work_.paths.size(); ++i) {
      const Path& path = work_.paths[i];
      if (path.hit.brdf.model == BrdfModel::lambert) {
        draw_cells(i, path.sharp ? 1 : bounce == 1 ? kFirstCellPart : kLaterCellPart);
      } else {
        draw_directions(i, path.sharp ? kSharpFactor * rays : rays);
      }
    }
    work_.visible.resize(work_.rays.size());
    scene_.visible(work_.rays, {}, work_.visible);
    for (std::size_t i = 0; i < work_.deposits.size(); ++i) {
      if (work_.visible[i] != 0) deposit(work_.deposits[i]);
    }
  }

  void draw_directions(std::size_t index, int rays) {
    const Path& path = work_.paths[index];
    const Brdf& brdf = path.hit.brdf;
    const Frame<float> frame = path.hit.frame();
    // An R2 sequence covers the lobe evenly at any number of rays; each path goes on where the one
    // before it stopped, so that neighbouring points complete each other.
    const double choice_shift = random_.uniform();
    for (int ray = 0; ray < rays; ++ray) {
      const Sample2 at = r2_point(layer_shift_, static_cast<int>(index) * rays + ray);
      const auto choice = static_cast<float>(fraction(choice_shift + ray * std::numbers::phi));
      const Vec3f out = frame.to_local(reflects_alike(path) ? path.out : random_out(path));
      const auto drawn = sample(brdf, out, choice, at);
      if (!drawn) continue;
      const Vec3f direction = frame.to_world(drawn->direction);
      if (!leaves_front(path.hit, direction)) continue;
      work_.deposits.push_back(make_deposit(index, *drawn, direction, out, frame));
      work_.deposits.back().share = 1 / static_cast<float>(rays);
      work_.rays.push_back({RayScene::ray_origin(path.hit, direction), direction});
    }
  }

  /// A shadow ray from a Lambert point to each `part`-th coarse texel above its horizon. Points
  /// take turns, so that a small bright light is found by as many of them as any other.
  void draw_cells(std::size_t index, std::uint64_t part) {
    const Path& path = work_.paths[index];
    const int size = settings_.coarse_size;
    const double area = 4.0 / (size * size);
    for (int cell = 0; cell < static_cast<int>(cube::texel_count(size)); ++cell) {
      if ((static_cast<std::uint64_t>(cell) + path.point + cell_phase_) % part != 0) continue;
      const Sample2 at = random_sample(random_);
      const double x = 2 * (cell % size + at.u) / size - 1;
      const double y = 2 * (cell / size % size + at.v) / size - 1;
      const Vec3f direction(cube::direction({cell / (size * size), x, y}));
      if (!leaves_front(path.hit, direction)) continue;
      const float cosine = dot(path.hit.shading_normal, direction);
      const auto solid_angle = static_cast<float>(area / std::pow(1 + x * x + y * y, 1.5));
      Deposit deposit;
      deposit.path = index;
      deposit.direction = direction;
      deposit.diffuse = path.throughput * path.hit.brdf.albedo *
                        (std::numbers::inv_pi_v<float> * cosine * solid_angle);
      deposit.share = static_cast<float>(part);
      work_.deposits.push_back(deposit);
      work_.rays.push_back({RayScene::ray_origin(path.hit, direction), direction});
    }
  }

  Deposit make_deposit(std::size_t index, const BrdfSample& drawn, const Vec3f& direction,
                       const Vec3f& out, const Frame<float>& frame) const {
    const Path& path = work_.paths[index];
    Deposit result;
    result.path = index;
    result.direction = direction;
    if (!reflects_alike(path)) {
      result.density = shared_density(path, frame, drawn.direction);
    } else if (!is_glossy(path.hit.brdf)) {
      result.diffuse = path.throughput * drawn.weight;
    } else {
      const float factor = drawn.direction.z / drawn.density;
      result.diffuse =
          path.throughput * evaluate_diffuse(path.hit.brdf, drawn.direction, out) * factor;
      result.glossy =
          path.throughput * evaluate_specular(path.hit.brdf, drawn.direction, out) * factor;
    }
    return result;
  }

  void deposit(const Deposit& what) {
    const Path& path = work_.paths[what.path];
    float* const coarse = work_.coarse.data() +
                          cube::texel_of(Vec3d(what.direction), settings_.coarse_size) * kRowLanes;
    float* const fine = rows_.row(cube::texel_of(Vec3d(what.direction), settings_.cube_size));
    const float* const weights = work_.layer.weight(path.point);
    if (what.density == 0) {
      if (max_component(what.diffuse) > 0)
        add_weighted_lanes(weights, what.diffuse * what.share, coarse);
      if (max_component(what.glossy) > 0)
        add_weighted_lanes(weights, what.glossy * what.share, fine);
      return;
    }
    reflect_to_viewers(path, what.direction, weights);
    const Vec3f value = Vec3f::filled(what.share / what.density);
    add_weighted_lanes(work_.diffuse_weights.data(), value, coarse);
    if (is_glossy(path.hit.brdf)) {
      add_weighted_lanes(work_.glossy_weights.data(), value, fine);
    } else {
      add_weighted_lanes(work_.glossy_weights.data(), value, coarse);
    }
  }

  /// weights · f(direction → viewer) · cos θ for every viewer, diffuse and glossy apart.
  void reflect_to_viewers(const Path& path, const Vec3f& direction, const float* weights) {
    const Frame<float> frame = path.hit.frame();
    const Vec3f in = frame.to_local(direction);
    std::fill(work_.diffuse_weights.begin(), work_.diffuse_weights.end(), 0.0f);
    std::fill(work_.glossy_weights.begin(), work_.glossy_weights.end(), 0.0f);
    for (const SharedLayer::Viewer& viewer : work_.layer.viewers) {
      const float* const weight = weights + viewer.lane;
      if (weight[0] == 0 && weight[kGroupLanes] == 0 && weight[2 * kGroupLanes] == 0) continue;
      const Vec3f out = frame.to_local(towards(viewer, path.hit));
      const Vec3f diffuse = evaluate_diffuse(path.hit.brdf, in, out) * in.z;
      const Vec3f glossy = evaluate_specular(path.hit.brdf, in, out) * in.z;
      for (int c = 0; c < 3; ++c) {
        const std::size_t at = static_cast<std::size_t>(c) * kGroupLanes;
        work_.diffuse_weights[at + viewer.lane] = weight[at] * diffuse[c];
        work_.glossy_weights[at + viewer.lane] = weight[at] * glossy[c];
      }
    }
  }

  /// The direction from a shared point towards a viewer picked at random.
  Vec3f random_out(const Path& path) {
    const auto& viewers = work_.layer.viewers;
    return towards(viewers[random_.below(viewers.size())], path.hit);
  }

  /// The density with which a random viewer's lobe draws a direction: the mean over viewers.
  float shared_density(const Path& path, const Frame<float>& frame, const Vec3f& in) const {
    float sum = 0;
    for (const SharedLayer::Viewer& viewer : work_.layer.viewers) {
      sum += density(path.hit.brdf, in, frame.to_local(towards(viewer, path.hit)));
    }
    return sum / static_cast<float>(work_.layer.viewers.size());
  }

  /// Each path goes on by one BRDF sample, or ends.
  void extend_paths() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < work_.paths.size(); ++i) {
      if (extend(work_.paths[i])) work_.paths[kept++] = work_.paths[i];
    }
    work_.paths.resize(kept);
  }

  bool extend(Path& path) {
    const Frame<float> frame = path.hit.frame();
    const bool alike = reflects_alike(path);
    const Vec3f out = frame.to_local(alike ? path.out : random_out(path));
    const float choice = random_.uniform_float();
    const auto drawn = sample(path.hit.brdf, out, choice, random_sample(random_));
    if (!drawn) return false;
    const Vec3f direction = frame.to_world(drawn->direction);
    if (!leaves_front(path.hit, direction)) return false;
    if (alike) {
      path.throughput *= drawn->weight;
    } else {
      turn_weights(path, direction, shared_density(path, frame, drawn->direction));
    }
    // Russian roulette: what is left in the mean stays the same.
    const float survival = std::min(1.0f, max_component(path.throughput));
    if (!(random_.uniform_float() < survival)) return false;
    path.throughput = path.throughput / survival;
    auto hit = scene_.intersect({RayScene::ray_origin(path.hit, direction), direction});
    if (!hit) return false;
    path.sharp = path.sharp && is_glossy(path.hit.brdf);
    path.hit = *hit;
    path.out = -direction;
    path.first = false;
    return true;
  }

  /// The viewers' weights of a shared point become those of the path's next point.
  void turn_weights(const Path& path, const Vec3f& direction, float density) {
    float* const weights = work_.layer.weight(path.point);
    reflect_to_viewers(path, direction, weights);
    for (std::size_t i = 0; i < kRowLanes; ++i) {
      weights[i] = (work_.diffuse_weights[i] + work_.glossy_weights[i]) / density;
    }
  }

  /// A coarse texel's transport goes to its fine texels in equal parts: only coarse bands hold it.
  void spread_coarse() {
    const auto side = static_cast<std::size_t>(settings_.cube_size);
    const auto coarse_side = static_cast<std::size_t>(settings_.coarse_size);
    const std::size_t ratio = side / coarse_side;
    const Vec3f part = Vec3f::filled(1.0f / static_cast<float>(ratio * ratio));
    for (std::size_t texel = 0; texel < cube::texel_count(settings_.cube_size); ++texel) {
      const std::size_t row =
          texel / side / ratio;  // faces follow each other: side / ratio is whole
      const std::size_t column = texel % side / ratio;
      const float* const from = work_.coarse.data() + (row * coarse_side + column) * kRowLanes;
      add_weighted_lanes(from, part, rows_.row(texel));
    }
  }

  static double fraction(double x) { return x - static_cast<double>(static_cast<std::int64_t>(x)); }

  const RayScene& scene_;
  const IndirectSettings& settings_;
  GroupRows& rows_;
  Random& random_;
  Workspace& work_;
  Sample2 layer_shift_;           // of the lobes' sequence, in one gathering
  std::uint64_t cell_phase_ = 0;  // which points take which coarse texels, in one gathering
};

}  // namespace

IndirectTransport::IndirectTransport(const RayScene& scene, const IndirectSettings& settings)
    : scene_(scene), settings_(settings) {
  settings_.coarse_size = std::min(settings_.coarse_size, settings_.cube_size);
}

IndirectTransport::~IndirectTransport() = default;

void IndirectTransport::add(const GroupSamples& samples, std::uint64_t seed,
                            GroupRows& rows) const {
  if (settings_.bounces == 0) return;
  thread_local Workspace work;
  Random random(seed, 0x1d1);
  Gatherer(scene_, settings_, rows, random, work).run(samples);
}

}  // namespace rimlight
