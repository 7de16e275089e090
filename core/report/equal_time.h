#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/light/environment.h"
#include "core/report/gnuplot.h"
#include "core/report/report_page.h"
#include "core/report/timed_policy.h"
#include "core/scene/scene.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// Relighting beside path tracing. The light turns by 90 degrees from one frame to the next; the
/// clock starts there. Both aim at the same picture: the scene under the bake's texels of light.
struct EqualTimeSettings {
  std::vector<std::shared_ptr<const Environment>> lights;  // empty: the bake's own
  std::vector<TimedPolicy> policies;                       // in milliseconds
  double seconds = 20;  // of path tracing for each light; as many again for the truth
  int frames = 60;      // of each policy, after the turn
};

/// How far a method has come after some time.
struct EqualTimeRow {
  std::string light;
  std::string method;   // a policy; kPathTracing; kDirectTracing
  std::string against;  // kTracedPicture, or kBakedPicture
  int steps = 0;        // frames, or paths a pixel
  double ms = 0;        // all of them together
  /// As displayed. Against a traced picture without that one's own noise; of kDirectTracing it is
  /// traced with direct light alone.
  double psnr_db = 0;
};
/// What a path tracer comes to: as many paths with other seeds.
inline constexpr const char* kTracedPicture = "traced picture";
/// What relighting comes to: the bake's reference rows under the whole light, or where it has none
/// the stored transport. From the traced one it is as far as the bake's own noise.
inline constexpr const char* kBakedPicture = "baked picture";
inline constexpr const char* kPathTracing = "path tracing";
inline constexpr const char* kDirectTracing = "path tracing, direct light only";

struct EqualTimeReport {
  std::string scene;
  int width = 0, height = 0, bounces = 0, cube_size = 0;
  std::size_t receivers = 0;  // measured on
  std::vector<EqualTimeRow> rows;
};

/// The truth of each light is path traced with other seeds, for as long. A policy's time is what
/// FrameTimes names, measured once against each picture; path tracing's is its paths alone, without
/// display. Throws Error when the bake is of another picture than the scene's.
EqualTimeReport measure_equal_time(const std::shared_ptr<const Scene>& scene, const Bake& bake,
                                   const EqualTimeSettings& settings,
                                   const std::function<void(const std::string&, double)>& progress);

/// Milliseconds until the rows of a light, method and picture like a given one's had `psnr_db`,
/// between two of its rows by the logarithm of time; nothing when it came never so far. Before its
/// first row: that row's.
std::optional<double> milliseconds_to(const EqualTimeReport& report, const EqualTimeRow& like,
                                      double psnr_db);

/// docs/formats/report.md.
nlohmann::json to_json(const EqualTimeReport& report);
ReportSection section_of(const EqualTimeReport& report);
/// PSNR against milliseconds, a picture a light. As draw_figures() of figures.h.
Figures draw_figures(const EqualTimeReport& report, const std::filesystem::path& folder);

}  // namespace rimlight
