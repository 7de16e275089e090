#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/light/cube_light.h"
#include "core/math/rotation.h"

namespace rimlight {

/// What is done against the ringing of a light that is cut off after its last degree; see
/// sh_window.h. `fitted` is the mildest diffusion that its own luminance needs.
enum class LightWindow { none, hann, lanczos, fitted };

/// Reads the name of one. Throws Error naming `where`, with the names that could stand there.
LightWindow parse_window(std::string_view text, const std::string& where);

/// An environment in spherical harmonics: projected once, turned for each frame. Immutable; any
/// thread.
class VertexLight {
 public:
  /// Degree 0 … sh::kLargestLightDegree, else CheckFailure.
  VertexLight(const CubeLight& texels, int degree, LightWindow window);

  /// [3][(degree + 1)²]
  std::span<const float> coefficients() const { return coefficients_; }
  int degree() const { return degree_; }
  /// The light's coefficients as it shines after the turn: from rotated(rotation, d) comes what
  /// came from d. Exact, as bands turn into themselves. `turned` is of the size of coefficients().
  void turn(const Quaternion& rotation, std::span<float> turned) const;

 private:
  int degree_;
  std::vector<float> coefficients_;
};

}  // namespace rimlight
