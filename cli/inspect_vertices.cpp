#include "cli/inspect_vertices.h"

#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "cli/inspect_parts.h"
#include "core/basis/sh.h"

namespace rimlight {
namespace {

using nlohmann::json;

/// Energy of each band, a vertex (and channel) on average.
json band_energies(std::span<const Half> rows, int degree, std::size_t vertices) {
  std::vector<double> energies(static_cast<std::size_t>(degree) + 1);
  const std::size_t coefficients = sh::coefficient_count(degree);
  for (std::size_t row = 0; row < rows.size() / kBatchVertices; ++row) {
    const auto band = static_cast<std::size_t>(sh::degree_of(row % coefficients));
    for (std::size_t lane = 0; lane < kBatchVertices; ++lane) {
      const double value = to_float(rows[row * kBatchVertices + lane]);
      energies[band] += value * value;
    }
  }
  for (double& energy : energies) energy /= static_cast<double>(vertices);
  return energies;
}

json describe_material(const VertexMaterial& material) {
  const auto rgb = [](const Vec3f& v) { return json{v.x, v.y, v.z}; };
  return {{"name", material.name},
          {"albedo", rgb(material.albedo)},
          {"highlight", rgb(material.highlight)},
          {"exponent", material.exponent}};
}

void print_bands(const char* title, const json& bands) {
  std::printf("\n  %s, mean energy by degree:", title);
  for (const json& energy : bands) std::printf(" %.3g", energy.get<double>());
  std::printf("\n");
}

}  // namespace

json describe_vertex_bake(const VertexBake& bake) {
  const VertexTransportView& transport = bake.transport();
  json result = {
      {"bake", bake.folder().string()},
      {"kind", kVertexKind},
      {"version", kBakeVersion},
      {"scene", bake.scene()},
      {"width", bake.width()},
      {"height", bake.height()},
      {"vertices", transport.vertex_count},
      {"triangles", bake.mesh().triangles.size()},
      {"highlight_vertices", transport.highlight_count},
      {"irradiance_degree", transport.irradiance_degree},
      {"irradiance_channels", transport.irradiance_channels},
      {"visibility_degree", transport.visibility_degree},
      {"transport_bytes", transport.irradiance.size_bytes() + transport.visibility.size_bytes()},
      {"settings", bake.settings()},
      {"measured", bake.measured()},
      {"left_out", bake.left_out()}};
  if (transport.irradiance_channels > 0) {
    result["irradiance_energy"] =
        band_energies(transport.irradiance, transport.irradiance_degree,
                      transport.vertex_count * transport.irradiance_channels);
  }
  if (transport.highlight_count > 0) {
    result["visibility_energy"] =
        band_energies(transport.visibility, transport.visibility_degree, transport.highlight_count);
  }
  for (const VertexMaterial& material : bake.materials()) {
    result["materials"].push_back(describe_material(material));
  }
  describe_files(bake.files(), result);
  describe_environments(bake.environments(), result);
  return result;
}

void print_vertex_bake(const json& bake, bool verified) {
  std::printf("%s: %s, %zu vertices, %zu triangles, degree %d in %zu channel(s), %.1f MiB%s\n",
              printable(bake["scene"].get<std::string>()).c_str(),
              bake["kind"].get<std::string>().c_str(), bake["vertices"].get<std::size_t>(),
              bake["triangles"].get<std::size_t>(), bake["irradiance_degree"].get<int>(),
              bake["irradiance_channels"].get<std::size_t>(), mebibytes(bake["bytes"]),
              verified ? ", every checksum right" : "");
  std::printf("  %zu vertices with a highlight, their visibility to degree %d\n",
              bake["highlight_vertices"].get<std::size_t>(), bake["visibility_degree"].get<int>());
  if (bake["settings"].contains("sun")) {
    std::printf("  a sun is shown as: %s\n", printable(bake["settings"]["sun"].dump()).c_str());
  }
  if (bake.contains("irradiance_energy")) {
    print_bands("irradiance", bake["irradiance_energy"]);
  } else {
    std::printf("\n  irradiance follows from the normals: none is stored\n");
  }
  if (bake.contains("visibility_energy")) print_bands("visibility", bake["visibility_energy"]);
  std::printf(
      "\n  material                       albedo              highlight           exponent\n");
  for (const json& material : bake["materials"]) {
    std::printf("  %-28s   %-17s   %-17s   %.1f\n",
                printable(material["name"].get<std::string>()).c_str(),
                three_numbers(material["albedo"]).c_str(),
                three_numbers(material["highlight"]).c_str(), material["exponent"].get<double>());
  }
  print_common(bake);
}

}  // namespace rimlight
