#pragma once

#include <nlohmann/json.hpp>
#include <vector>

namespace rimlight {

/// What a bake of vertices says of its own error: mean squares of the error of one coefficient of a
/// vertex, by band, [degree + 1] each, over vertices. Empty: nothing is known, or there is none.
struct VertexBakeError {
  bool is_known = false;
  double asked = 0;  // the error of a vertex that rays were traced for; 0: unknown
  /// By chance, of each vertex for itself: sampling.
  struct Sampling {
    std::vector<double> matt;        // irradiance of vertices without a highlight
    std::vector<double> glossy;      // of those with one
    std::vector<double> visibility;  // of those with one
  } sampling;
  /// Alike in neighbouring vertices: what was left out. Bands may go beyond those that are stored.
  std::vector<double> irradiance_left_out, visibility_left_out;
};

/// From the `measured` and `left_out` of a manifest (docs/formats/vertex_bake.md); members that are
/// missing, or not what they should be, are left out: people may have written them.
///
/// Sampling's squares are half of those that the bake's replicates say: those are too large by 2
/// where the edges of occluders make the error (ReplicateMean, ray_rounds.h). Of a bake without
/// `rms_by_band` they are from `rms_error`: all of it where a vertex has no highlight, else a
/// quarter for irradiance and three for visibility, as cos² has a mean of a third over the
/// hemisphere. Of indirect light, and of colours left out, the total is known but not its bands:
/// they are taken to be those of the clamped cosine, as what surfaces pass on is as smooth.
VertexBakeError bake_error_of(const nlohmann::json& settings, const nlohmann::json& measured,
                              const nlohmann::json& left_out, int degree);

}  // namespace rimlight
