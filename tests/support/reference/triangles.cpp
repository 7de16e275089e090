#include "tests/support/reference/triangles.h"

namespace rimlight::reference {

std::optional<TriangleHit> nearest_hit(const Scene& scene, const Vec3d& origin,
                                       const Vec3d& direction, double margin, double far) {
  std::optional<TriangleHit> nearest;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Vec3d a(mesh.positions[mesh.triangles[t][0]]);
      const Vec3d ab = Vec3d(mesh.positions[mesh.triangles[t][1]]) - a;
      const Vec3d ac = Vec3d(mesh.positions[mesh.triangles[t][2]]) - a;
      const Vec3d p = cross(direction, ac);
      const double determinant = dot(ab, p);
      if (determinant == 0) continue;
      const Vec3d q = cross(origin - a, ab);
      const double u = dot(origin - a, p) / determinant;
      const double v = dot(direction, q) / determinant;
      const double distance = dot(ac, q) / determinant;
      if (u < -margin || v < -margin || u + v > 1 + margin) continue;
      if (distance <= -margin || distance >= far + margin) continue;
      if (!nearest || distance < nearest->distance) nearest = TriangleHit{m, t, distance, u, v};
    }
  }
  return nearest;
}

}  // namespace rimlight::reference
