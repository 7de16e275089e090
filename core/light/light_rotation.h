#pragma once

#include <memory>

#include "core/light/cube_light.h"
#include "core/math/rotation.h"

namespace rimlight {

/// Rotates a cube-map light at frame rate: target(R ω) = source(ω).
///
///   conservative   ∫L dω is kept to 0.1 %, for one lit texel too, and without any global rescaling
///   constant       a uniform light stays uniform to 0.1 % at every texel
///   exact place    a lit texel's centroid stays within 0.1 texel, and moves continuously
///
/// No one kind of weight does all three on a cube map, whose texels differ in solid angle by 5.2.
/// So the source is split, once and for each channel, at 16 times its mean:
///
///   base     what lies below: each texel is shared out by the solid angle that it overlaps with
///            each target texel; constant and conservative, with a centroid that may be half a
///            texel off
///   excess   what lies above, in at most 1/16 of the sphere: the texel's energy, cut into pieces
///            of at most half a target texel, is shared out bilinearly (CubeSplat): conservative
///            with exact centroids, but not constant
///
/// Owns its workspace: rotate() allocates nothing once `target` has its size. One thread at a time.
class LightRotator {
 public:
  /// Values finite and not negative, else CheckFailure.
  explicit LightRotator(CubeLight source);
  LightRotator(LightRotator&& other) noexcept;
  LightRotator& operator=(LightRotator&& other) noexcept;
  ~LightRotator();

  const CubeLight& source() const { return source_; }

  /// `rotation` is a unit quaternion to 1e-6. `target` is resized to the source's size. Always from
  /// the source: errors of repeated turns do not add up. The identity returns the source bit for
  /// bit.
  void rotate(const Quaternion& rotation, CubeLight& target);

 private:
  class Workspace;

  CubeLight source_;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace rimlight
