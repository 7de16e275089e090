#pragma once

#include "core/light/cube_light.h"
#include "core/math/rotation.h"

namespace rimlight {

/// Rotates a cube-map light at frame rate, conservative and constant: target(R ω) = source(ω), each
/// source texel's energy shared out among the target texels it overlaps.
/// Owns its workspace: rotate() allocates nothing after the first call. One thread at a time.
class LightRotator {
 public:
  explicit LightRotator(CubeLight source);

  const CubeLight& source() const { return source_; }

  /// `rotation` is a unit quaternion to 1e-6. `target` is resized to the source's size. Always from
  /// the source: errors of repeated turns do not add up. The identity returns the source bit for
  /// bit.
  void rotate(const Quaternion& rotation, CubeLight& target);

 private:
  CubeLight source_;
};

}  // namespace rimlight
