#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/bake/group_source.h"
#include "core/light/environment.h"
#include "core/math/camera.h"
#include "core/transport/curve_receivers.h"

namespace rimlight {

/// Told as a bake goes on, from one thread.
struct BakeProgress {
  std::string stage;     // "tracing", "compressing", …
  double fraction = 0;   // of the stage, in [0, 1]
  bool resumed = false;  // this step was found done
};

struct BakeSummary {
  double seconds = 0;
  std::size_t resumed_tiles = 0;
  std::size_t bytes = 0;     // of stored transport
  double worst_psnr_db = 0;  // of the compressed transport, over the check lights
  std::string worst_light;
};

/// Of a bake of kind brdf_curve: what its transport lacks.
struct CurvePart {
  std::vector<CurveMaterial> materials, measured;
  CurveReceivers receivers;  // their views
  /// Of each environment: radiance to add to the pixels for its exposure, [environment][receiver].
  std::vector<std::vector<Vec3f>> images;
};

/// What a bake keeps beside its transport.
struct BakeRequest {
  std::string scene;  // its name
  Camera camera;
  std::vector<Environment> environments;               // at least one; the first is the default
  nlohmann::json settings;                             // for people: what it was baked with
  nlohmann::json measured = nlohmann::json::object();  // and what was measured before
  double psnr_db = 50;
  std::uint64_t seed = 1;
  std::size_t reference_receivers = 0;  // of which rows are kept as they are; 0: none
  std::uint64_t fingerprint = 0;        // of all that the source's rows depend on
  std::string stage = "tracing";        // what making rows is called
  /// For reference rows, where there are such: the source with another seed, from which a report
  /// tells the noise of M, and on a cube map of twice the size, from which it tells what N's texels
  /// average away.
  const GroupSource* retraced = nullptr;
  const GroupSource* finer = nullptr;
  const CurvePart* curves = nullptr;  // or the transport holds all light
};

/// Bakes a source's transport to `folder` (NAME.bake). Uses all cores; memory is bounded by a group
/// of dense rows a core, one tile of what is kept, and the sketch. An interrupted bake of the same
/// fingerprint resumes at a tile of 64×64 pixels finished a few seconds before; the bytes do not
/// depend on threads or interruptions. The compression is chosen so that every check light keeps
/// psnr_db against the uncompressed transport. Throws Error when the source has no receivers, or
/// when the folder cannot be written.
BakeSummary bake_transport(const GroupSource& source, const BakeRequest& request,
                           const std::filesystem::path& folder,
                           const std::function<void(const BakeProgress&)>& progress);

}  // namespace rimlight
