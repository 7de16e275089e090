#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "core/light/cube_light.h"
#include "core/scene/scene.h"

namespace rimlight::stability {

/// A Lambert material, grey.
Material matte(float albedo);

/// A ball on a plane beside a box, 24×24 pixels, N = 8, two bounces: everything `scale` times as
/// large.
std::shared_ptr<Scene> still_life(double scale = 1);

/// What stretches a mesh.
void scale_by(Mesh& mesh, double scale);

/// The inside of a unit sphere whose upper part is missing, `open` of its surface, seen from its
/// middle: under a uniform sky of radiance 1 its radiance is ρ f / (1 − ρ (1 − f)) everywhere.
/// `segments` around. Normals look inside for kind vertex_sh, else there are none.
struct OpenSphere {
  double open = 0.1;
  float albedo = 0.5f;
  BakeKind kind = BakeKind::image_haar;
  int segments = 64;
};
std::shared_ptr<Scene> open_sphere(const OpenSphere& settings);

/// Radiance of all pixels (of receivers that geometry covers, in their order) under a light's
/// texels, by the transport that bakes of kind image_haar store, before anything is left out.
std::vector<Vec3f> picture_of(const std::shared_ptr<const Scene>& scene, const CubeLight& light);

/// Haar coefficients of a light's texels.
CubeLight coefficients_of(const CubeLight& texels);

/// Radiance 1 everywhere; and random radiance, the same for the same size.
CubeLight uniform_sky(int size);
CubeLight random_sky(int size);

/// A new empty folder, which goes away with what is in it.
class ScratchFolder {
 public:
  ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace rimlight::stability
