#pragma once

#include <vector>

#include "core/bake/group.h"
#include "core/base/aligned_vector.h"
#include "core/math/sampling.h"

namespace rimlight {

/// One layer of a group: the k-th primary hit of each lane, and the second surface points that they
/// share.
struct SharedLayer {
  struct Viewer {
    std::size_t lane = 0;
    const SurfaceHit* hit = nullptr;
    Frame<float> frame{Vec3f{0, 0, 1}};
    Vec3f out;  // towards the camera, local
  };
  std::vector<Viewer> viewers;

  struct Point {
    SurfaceHit hit;
    std::size_t origin = 0;  // the viewer that made it
    Vec3f out;               // towards that viewer, world
  };
  std::vector<Point> points;

  /// What one unit of radiance from a point towards a lane adds to that pixel: [points][3][64].
  /// The mean over the pixel's primary rays is taken in: summing over layers and points gives the
  /// pixel.
  AlignedVector<float> weights;

  float* weight(std::size_t point) { return weights.data() + point * kRowLanes; }

  // Scratch of make_shared_layer, kept between calls.
  struct Pair {
    std::size_t viewer = 0, point = 0;
    float density = 0;  // with which the viewer makes the point, per area
    Vec3f value;        // f · cos θ · cos θ_y / r²
  };
  std::vector<Pair> pairs;
  std::vector<Ray> rays;
  std::vector<float> far;
  std::vector<std::uint8_t> visible;
  std::vector<float> density_sum;
};

/// Where a group's sequence of second points begins: uniform random numbers.
struct LayerShift {
  Sample2 direction;
  double choice = 0;
};

/// Fills a layer: samples a second point for each lane whose `ray`-th primary ray hit something,
/// traces the visibility of every pair and weights it by the balance heuristic. The estimator of a
/// lane is Σ_points value / Σ_viewers density, and unbiased as each viewer makes one sample.
void make_shared_layer(const RayScene& scene, const GroupSamples& samples, int ray,
                       const LayerShift& shift, SharedLayer& layer);

/// The surface's side that a direction leaves on: true on the side that the hit was seen from.
bool leaves_front(const SurfaceHit& hit, const Vec3f& direction);

}  // namespace rimlight
