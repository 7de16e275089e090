#include "core/bake/vertex_sh_bake.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/bake/vertex_bounces.h"
#include "core/bake/vertex_exposure.h"
#include "core/bake/vertex_gather.h"
#include "core/bake/vertex_visibility.h"
#include "core/base/checked.h"
#include "core/base/error.h"
#include "core/base/stopwatch.h"
#include "core/basis/sh.h"
#include "core/transport/vertex_bake.h"

namespace rimlight {
namespace {

constexpr std::size_t kMostCoefficients = std::size_t{1} << 32;
/// Of the error asked for, the part that the end of the series of bounces may have.
constexpr double kBouncesShare = 0.1;

using Progress = std::function<void(const BakeProgress&)>;

const char* transfer_name(VertexTransfer transfer) {
  switch (transfer) {
    case VertexTransfer::unshadowed:
      return "unshadowed";
    case VertexTransfer::shadowed:
      return "shadowed";
    case VertexTransfer::interreflected:
      return "interreflected";
  }
  return "";
}

/// Harmonics, unless asked otherwise, where they carry what of the sun's light takes a way that a
/// direction does not show.
const char* sun_name(const Scene& scene) {
  const bool indirect = scene.bake.vertex.transfer == VertexTransfer::interreflected ||
                        std::ranges::any_of(scene.materials, [](const Material& m) {
                          return m.subsurface.has_value();
                        });
  const SunLight by_itself = indirect ? SunLight::harmonics : SunLight::directional;
  return scene.bake.vertex.sun.value_or(by_itself) == SunLight::directional ? "directional"
                                                                            : "harmonics";
}

void check_size(const Scene& scene, const PreparedVertices& prepared) {
  const int degree = scene.bake.vertex.degree;
  if (degree < 0 || degree > kLargestVertexDegree) {
    throw Error(scene.name, "degree " + std::to_string(degree),
                "0 to " + std::to_string(kLargestVertexDegree));
  }
  const std::size_t vertices = prepared.mesh.positions.size();
  const auto count = checked_product(vertices, sh::coefficient_count(degree));
  if (count && *count <= kMostCoefficients) return;
  throw Error(scene.name,
              std::to_string(vertices) + " vertices of degree " + std::to_string(degree),
              "at most " + std::to_string(kMostCoefficients) + " coefficients");
}

bool is_grey(const std::vector<Vec3f>& colours) {
  return std::ranges::all_of(colours, [](const Vec3f& c) { return c.x == c.y && c.y == c.z; });
}

std::vector<float> channel_of(const std::vector<Vec3f>& colours, int c) {
  std::vector<float> values(colours.size());
  std::ranges::transform(colours, values.begin(), [c](const Vec3f& v) { return v[c]; });
  return values;
}

std::vector<float> largest_of(const std::vector<Vec3f>& colours) {
  std::vector<float> values(colours.size());
  std::ranges::transform(colours, values.begin(), [](const Vec3f& v) { return max_component(v); });
  return values;
}

/// The calculation, step by step.
class VertexCalculation {
 public:
  VertexCalculation(const Scene& scene, const PreparedVertices& prepared, const Progress& progress)
      : scene_(scene),
        prepared_(prepared),
        settings_(scene.bake.vertex),
        progress_(progress),
        coefficients_(sh::coefficient_count(settings_.degree)) {}

  CalculatedVertices run() {
    CalculatedTransport& transport = result_.transport;
    transport.vertex_count = prepared_.mesh.positions.size();
    transport.highlight_count = prepared_.highlight_count;
    transport.degree = settings_.degree;
    if (settings_.transfer == VertexTransfer::unshadowed) {
      VertexVisibility found =
          unshadowed_visibility(prepared_.mesh, prepared_.highlight_count, settings_.degree);
      finish(std::move(found), nullptr, {});
      return std::move(result_);
    }
    const RayScene rays = ray_scene_of(prepared_.mesh);
    VertexVisibility found =
        shadowed_visibility(rays, prepared_.mesh, prepared_.highlight_count, ray_settings(),
                            [this](double share) { report("tracing visibility", share); });
    measure(found);
    if (settings_.transfer == VertexTransfer::shadowed) {
      finish(std::move(found), nullptr, {});
      return std::move(result_);
    }
    const auto albedo = bounced_albedo(prepared_.mesh, prepared_.materials);
    const Gathered gathered =
        gather(rays, prepared_.mesh, found.blocked, largest_of(albedo), found.irradiance,
               ray_settings(), [this](double share) { report("tracing surfaces", share); });
    measure(gathered);
    finish(std::move(found), &gathered.matrix, albedo);
    return std::move(result_);
  }

 private:
  void report(const char* stage, double share) const {
    if (progress_) progress_({stage, share});
  }

  RaySettings ray_settings() const {
    return {settings_.degree, settings_.error, settings_.most_rays, scene_.bake.seed};
  }

  /// Bounces, and light below surfaces, to the end.
  void finish(VertexVisibility found, const GatherMatrix* matrix,
              const std::vector<Vec3f>& albedo) {
    const SubsurfaceSpread spread(prepared_.mesh, scene_.materials);
    result_.transport.is_open =
        settings_.transfer == VertexTransfer::unshadowed && !spread.is_needed();
    const bool grey = is_grey(albedo) && !(spread.is_needed() && spread.is_coloured());
    const GatherMatrix none{std::vector<std::uint64_t>(result_.transport.vertex_count + 1), {}, {}};
    auto& channels = result_.transport.irradiance;
    channels.assign(grey ? 1 : 3, found.irradiance);
    for (std::size_t c = 0; c < channels.size(); ++c) {
      report("bouncing light", static_cast<double>(c) / static_cast<double>(channels.size()));
      const Bounces bounces = add_bounces(
          matrix != nullptr ? *matrix : none, channel_of(albedo, static_cast<int>(c)), spread,
          static_cast<int>(c), coefficients_, kBouncesShare * settings_.error, channels[c]);
      if (matrix == nullptr) continue;
      measured()["bounces"].push_back(bounces.count);
      measured()["bounces_left"].push_back(bounces.left);
    }
    report("bouncing light", 1);
    result_.transport.visibility = std::move(found.visibility);
  }

  nlohmann::json& measured() { return result_.measured; }

  void measure(const VertexVisibility& found) {
    const std::size_t rays = std::accumulate(found.rays.begin(), found.rays.end(), std::size_t{0});
    const auto capped = static_cast<std::size_t>(std::ranges::count_if(
        found.error, [this](float error) { return error > settings_.error; }));
    double squares = 0;
    for (const float error : found.error) squares += static_cast<double>(error) * error;
    const double worst = *std::ranges::max_element(found.error);
    measured()["visibility"] = {
        {"rays", rays},
        {"rms_error", std::sqrt(squares / static_cast<double>(found.error.size()))},
        {"worst_error", worst},
        {"rms_by_band",
         {{"irradiance", found.rms_by_band.irradiance},
          {"irradiance_beside_highlight", found.rms_by_band.irradiance_beside_highlight},
          {"visibility", found.rms_by_band.visibility}}},
        {"vertices_at_most_rays", capped}};
    result_.rays += rays;
    result_.capped_vertices = capped;
    result_.worst_error = worst;
  }

  void measure(const Gathered& gathered) {
    measured()["indirect"] = {{"rays", gathered.rays},
                              {"rms_error", gathered.rms_error},
                              {"worst_error", gathered.worst_error},
                              {"vertices_at_most_rays", gathered.capped_vertices}};
    result_.rays += gathered.rays;
    result_.capped_vertices += gathered.capped_vertices;
    result_.worst_error = std::max(result_.worst_error, gathered.worst_error);
  }

  const Scene& scene_;
  const PreparedVertices& prepared_;
  const VertexBakeSettings& settings_;
  const Progress& progress_;
  std::size_t coefficients_;
  CalculatedVertices result_;
};

VertexBakeManifest describe(const Scene& scene, const PreparedVertices& prepared,
                            const CalculatedVertices& calculated, const StoredTransport& stored) {
  const VertexBakeSettings& vertex = scene.bake.vertex;
  VertexBakeManifest manifest{.scene = scene.name,
                              .width = scene.bake.width,
                              .height = scene.bake.height,
                              .camera = scene.camera,
                              .materials = prepared.materials};
  manifest.settings = {{"degree", vertex.degree},
                       {"error", vertex.error},
                       {"transfer", transfer_name(vertex.transfer)},
                       {"most_rays", vertex.most_rays},
                       {"keep_bands", vertex.keep_bands},
                       {"longest_edge", vertex.longest_edge},
                       {"sun", sun_name(scene)},
                       {"seed", scene.bake.seed}};
  manifest.measured = calculated.measured;
  manifest.measured["mesh"] = {{"computed_normals", prepared.computed_normals},
                               {"joined_vertices", prepared.joined_vertices},
                               {"added_vertices", prepared.added_vertices}};
  manifest.left_out = stored.left_out;
  manifest.left_out["mesh"] = {
      {"unused_vertices", prepared.unused_vertices},
      {"triangles_without_area", scene.dropped_triangles + prepared.dropped_triangles}};
  const auto approximated = std::ranges::count_if(scene.materials, [](const Material& material) {
    return material.brdf.model != BrdfModel::lambert && material.brdf.model != BrdfModel::phong;
  });
  if (approximated > 0) manifest.left_out["gloss_as_phong_lobes"] = approximated;
  return manifest;
}

VertexBakeSummary summary_of(const VertexBakeManifest& manifest, const PreparedVertices& prepared,
                             const CalculatedVertices& calculated, const StoredTransport& stored) {
  return {.vertices = prepared.mesh.positions.size(),
          .triangles = prepared.mesh.triangles.size(),
          .highlight_vertices = prepared.highlight_count,
          .computed_normals = prepared.computed_normals,
          .unused_vertices = prepared.unused_vertices,
          .dropped_triangles = manifest.left_out["mesh"]["triangles_without_area"],
          .irradiance_degree = stored.view.irradiance_degree,
          .visibility_degree = stored.view.visibility_degree,
          .irradiance_channels = stored.view.irradiance_channels,
          .rays = calculated.rays,
          .capped_vertices = calculated.capped_vertices,
          .worst_error = calculated.worst_error,
          .bytes = (stored.irradiance.size() + stored.visibility.size()) * sizeof(Half)};
}

}  // namespace

CalculatedVertices calculate_vertices(const Scene& scene, const PreparedVertices& prepared,
                                      const Progress& progress) {
  check_size(scene, prepared);
  return VertexCalculation(scene, prepared, progress).run();
}

VertexBakeSummary bake_vertices(const std::shared_ptr<const Scene>& scene,
                                const std::filesystem::path& folder, const Progress& progress) {
  const Stopwatch watch;
  const PreparedVertices prepared = prepare_vertices(*scene);
  check_size(*scene, prepared);
  BakeWriter writer(folder);  // early: a folder that is no bake is told before the work
  const CalculatedVertices calculated = calculate_vertices(*scene, prepared, progress);
  if (progress) progress({"writing", 0});
  const VertexBakeSettings& settings = scene->bake.vertex;
  const StoredTransport stored = pack(calculated.transport, {settings.error, settings.keep_bands});
  for (const Environment& environment : scene->environments) {
    writer.add_environment({std::make_shared<const Environment>(environment),
                            vertex_exposure_scale(prepared, calculated.transport, environment)});
  }
  const VertexBakeManifest manifest = describe(*scene, prepared, calculated, stored);
  commit_vertex_bake(writer, manifest, prepared.mesh, stored.view);
  if (progress) progress({"writing", 1});
  VertexBakeSummary summary = summary_of(manifest, prepared, calculated, stored);
  summary.seconds = watch.elapsed_ms() / 1000;
  return summary;
}

}  // namespace rimlight
