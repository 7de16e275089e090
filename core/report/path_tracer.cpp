#include "core/report/path_tracer.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/basis/cube_map.h"
#include "core/math/random.h"
#include "core/math/sampling.h"

namespace rimlight {
namespace {

constexpr int kTileSide = 16;
/// Bounces that no path is ended before.
constexpr int kSureBounces = 2;

double luminance(const Vec3f& radiance) {
  return 0.2126 * radiance.x + 0.7152 * radiance.y + 0.0722 * radiance.z;
}

bool leaves_front(const SurfaceHit& hit, const Vec3f& direction) {
  return dot(direction, hit.geometric_normal) > 0 && dot(direction, hit.shading_normal) > 0;
}

}  // namespace

TexelSampler::TexelSampler(const CubeLight& texels) : texels_(texels) {
  const std::size_t count = texels.count();
  std::vector<double> weights(count);
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    weights[i] = luminance(texels.at(i)) * cube::texel_solid_angle(i, texels.size);
    sum += weights[i];
  }
  cumulative_.resize(count);
  double before = 0;
  for (std::size_t i = 0; i < count; ++i) {
    before += sum > 0 ? weights[i] / sum : 1.0 / static_cast<double>(count);
    cumulative_[i] = before;
  }
  cumulative_.back() = 1;
}

float TexelSampler::density(std::size_t texel, double x, double y) const {
  const double share = cumulative_[texel] - (texel == 0 ? 0 : cumulative_[texel - 1]);
  const double area = 4.0 / (static_cast<double>(texels_.size) * texels_.size);
  return static_cast<float>(share / area * std::pow(1 + x * x + y * y, 1.5));
}

TexelSampler::Drawn TexelSampler::draw(double choice, const Sample2& at) const {
  const auto found = std::ranges::upper_bound(cumulative_, choice);
  const auto texel =
      std::min(static_cast<std::size_t>(found - cumulative_.begin()), cumulative_.size() - 1);
  const auto side = static_cast<std::size_t>(texels_.size);
  const double x = 2 * (static_cast<double>(texel % side) + at.u) / texels_.size - 1;
  const double y = 2 * (static_cast<double>(texel / side % side) + at.v) / texels_.size - 1;
  const int face = static_cast<int>(texel / (side * side));
  return {Vec3f(cube::direction({face, x, y})), texels_.at(texel), density(texel, x, y)};
}

float TexelSampler::density(const Vec3f& direction) const {
  const cube::FacePoint point = cube::face_point(Vec3d(direction));
  return density(cube::texel_of(Vec3d(direction), texels_.size), point.x, point.y);
}

Vec3f TexelSampler::radiance(const Vec3f& direction) const {
  return texels_.at(cube::texel_of(Vec3d(direction), texels_.size));
}

/// The paths of one tile of pixels, a bounce at a time.
class PathTracer::Tile {
 public:
  Tile(const PathTracer& tracer, RgbImage& sum) : tracer_(tracer), sum_(sum) {}

  void run(int left, int top, Random random) {
    begin(left, top, random);
    intersect();
    for (int bounce = 0; bounce <= tracer_.bounces_ && !paths_.empty(); ++bounce) {
      add_direct(random);
      go_on(bounce, random);
      intersect();  // after the last bounce for the light that it may see, and no more
    }
  }

 private:
  struct Path {
    std::size_t pixel = 0;
    Ray ray;
    Vec3f throughput{1, 1, 1};
    float density = 0;  // with which the ray's direction was drawn; 0: it is the camera's
    SurfaceHit hit;
  };
  struct Shadow {
    std::size_t pixel = 0;
    Vec3f radiance;  // when nothing is in the way
  };

  void begin(int left, int top, Random& random) {
    const BakeSettings& bake = tracer_.scene_.scene().bake;
    const Camera& camera = tracer_.scene_.scene().camera;
    paths_.clear();
    for (int y = top; y < std::min(top + kTileSide, bake.height); ++y) {
      for (int x = left; x < std::min(left + kTileSide, bake.width); ++x) {
        const double px = x + random.uniform(), py = y + random.uniform();
        Path& path = paths_.emplace_back();
        path.pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(bake.width) +
                     static_cast<std::size_t>(x);
        path.ray = {Vec3f(camera.position),
                    Vec3f(camera.ray_direction(px, py, bake.width, bake.height))};
      }
    }
  }

  /// Paths that meet nothing bring the light that they see, and end.
  void intersect() {
    std::size_t kept = 0;
    for (Path& path : paths_) {
      if (auto hit = tracer_.scene_.intersect(path.ray)) {
        path.hit = *hit;
        if (&paths_[kept] != &path) paths_[kept] = path;
        ++kept;
        continue;
      }
      if (path.density <= 0) continue;  // straight from the camera: the background
      const Vec3f& direction = path.ray.direction;
      const float other = tracer_.sampler_.density(direction);
      sum_.pixels[path.pixel] += path.throughput * tracer_.sampler_.radiance(direction) *
                                 (path.density / (path.density + other));
    }
    paths_.resize(kept);
  }

  void add_direct(Random& random) {
    rays_.clear();
    shadows_.clear();
    for (const Path& path : paths_) {
      const double choice = random.uniform();
      const TexelSampler::Drawn light = tracer_.sampler_.draw(choice, random_sample(random));
      if (!leaves_front(path.hit, light.direction)) continue;
      const Frame<float> frame = path.hit.frame();
      const Vec3f in = frame.to_local(light.direction);
      const Vec3f out = frame.to_local(-path.ray.direction);
      const Vec3f reflected = evaluate(path.hit.brdf, in, out) * in.z;
      if (max_component(reflected) <= 0 || light.density <= 0) continue;
      const float other = rimlight::density(path.hit.brdf, in, out);
      rays_.push_back({RayScene::ray_origin(path.hit, light.direction), light.direction});
      shadows_.push_back({path.pixel, path.throughput * reflected * light.radiance *
                                          (1 / (light.density + other))});
    }
    visible_.resize(rays_.size());
    tracer_.scene_.visible(rays_, {}, visible_);
    for (std::size_t i = 0; i < shadows_.size(); ++i) {
      if (visible_[i] != 0) sum_.pixels[shadows_[i].pixel] += shadows_[i].radiance;
    }
  }

  void go_on(int bounce, Random& random) {
    std::size_t kept = 0;
    for (const Path& path : paths_) {
      const Frame<float> frame = path.hit.frame();
      const Vec3f out = frame.to_local(-path.ray.direction);
      const float choice = random.uniform_float();
      const auto next = sample(path.hit.brdf, out, choice, random_sample(random));
      if (!next) continue;
      const Vec3f direction = frame.to_world(next->direction);
      if (!leaves_front(path.hit, direction)) continue;
      Vec3f throughput = path.throughput * next->weight;
      if (bounce >= kSureBounces) {
        const float survival = std::min(1.0f, max_component(throughput));
        if (random.uniform_float() >= survival) continue;
        throughput = throughput * (1 / survival);
      }
      Path& on = paths_[kept++];
      on.ray = {RayScene::ray_origin(path.hit, direction), direction};
      on.pixel = path.pixel;
      on.throughput = throughput;
      on.density = next->density;
    }
    paths_.resize(kept);
  }

  const PathTracer& tracer_;
  RgbImage& sum_;
  std::vector<Path> paths_;
  std::vector<Ray> rays_;
  std::vector<Shadow> shadows_;
  std::vector<std::uint8_t> visible_;
};

void PathTracer::add_pass(std::uint64_t seed, std::uint64_t pass, RgbImage& sum) const {
  const BakeSettings& bake = scene_.scene().bake;
  RIMLIGHT_CHECK(sum.width == bake.width && sum.height == bake.height);
  const int columns = (bake.width + kTileSide - 1) / kTileSide;
  const int rows = (bake.height + kTileSide - 1) / kTileSide;
  const auto tiles = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  parallel_for(tiles, [&](std::size_t tile) {
    const int index = static_cast<int>(tile);
    Tile paths(*this, sum);
    paths.run(index % columns * kTileSide, index / columns * kTileSide,
              Random(seed, pass * tiles + tile));
  });
}

PathTracer::PathTracer(const RayScene& scene, const CubeLight& texels, int bounces)
    : scene_(scene), sampler_(texels), bounces_(bounces) {
  RIMLIGHT_CHECK(bounces >= 0);
}

}  // namespace rimlight
