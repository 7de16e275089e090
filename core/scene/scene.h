#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "core/light/environment.h"
#include "core/light/sun_and_sky.h"
#include "core/material/brdf.h"
#include "core/material/measured_lobe.h"
#include "core/math/camera.h"
#include "core/math/vec.h"

namespace rimlight {

/// Triangles of one material. Normals (unit) and texture coordinates are per vertex, and optional
/// (empty).
struct Mesh {
  std::string name;
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
  /// v = 0 is the bottom of the picture.
  struct TextureCoordinate {
    float u = 0, v = 0;
  };
  std::vector<TextureCoordinate> texture_coordinates;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint32_t material = 0;
};

/// Light that enters a surface and leaves it elsewhere: a homogeneous medium, per unit of length of
/// the scene. Only bakes of kind vertex_sh look at it.
struct Subsurface {
  Vec3f absorption;  // σ_a
  Vec3f scattering;  // σ_s′, reduced
  float eta = 1.3f;  // relative index of refraction
};

struct Material {
  std::string name;
  Brdf brdf;
  std::shared_ptr<const RgbImage> albedo_texture;  // multiplies brdf.albedo; repeats; bilinear
  /// The direction in the world, of any length, along which an anisotropic BRDF's x axis lies, as
  /// nearly as the surface allows: that of the brush, say. It does not turn with objects.
  Vec3f tangent{1, 0, 0};
  std::optional<Subsurface> subsurface = std::nullopt;
  /// Of the model measured: what brdf.measured points to, and its name among the scene's.
  std::shared_ptr<const MeasuredLobe> measured = nullptr;
  std::string measured_name = {};
};

/// A measured BRDF, read from its file and factorized. Bakes of kind brdf_curve keep all of a
/// scene's, so that sessions may load them.
struct MeasuredReflection {
  std::string name;
  std::filesystem::path file;
  std::shared_ptr<const MeasuredLobe> lobe;
};

/// What a bake's receivers and its basis are: pixels and Haar functions on a cube map, or vertices
/// and spherical harmonics, or pixels whose direct light by some materials follows their curves.
enum class BakeKind { image_haar, vertex_sh, brdf_curve };

/// What a vertex' transport holds.
enum class VertexTransfer {
  unshadowed,      // the cosine above its tangent plane
  shadowed,        // and what stands in the way
  interreflected,  // and light by way of other surfaces
};

/// What to bake for kind vertex_sh, beside the picture's sides and the seed.
struct VertexBakeSettings {
  static constexpr int kLargestDegree = 20;

  int degree = 10;
  /// Standard error of a vertex' coefficients, root mean square over them, that is asked for.
  double error = 0.01;
  VertexTransfer transfer = VertexTransfer::interreflected;
  int most_rays = 4096;     // per vertex, for its visibility; as many for its indirect light
  bool keep_bands = false;  // those, too, that the error does not need
  /// Longer edges are split, as a share of the longest side of the scene's box; 0: none is.
  double longest_edge = 0.01;
  /// Else harmonics where light goes from surface to surface, or below one, and apart without.
  std::optional<SunLight> sun = std::nullopt;
};

/// What to bake, with DESIGN's defaults.
struct BakeSettings {
  BakeKind kind = BakeKind::image_haar;
  VertexBakeSettings vertex;
  int width = 512;
  int height = 512;
  int cube_size = 32;     // N: a power of two, 4 … 128
  int primary_rays = 16;  // per pixel
  int bounces = 4;        // 0: direct light only
  double psnr_db = 50;    // of the compressed against the uncompressed transport
  std::uint64_t seed = 1;
  /// brdf_curve: names of the materials whose BRDFs sessions edit; empty: all with a gloss.
  std::vector<std::string> editable = {};
  /// Rows to keep as they are, for reports; no scene source says it, and no transport depends on
  /// it.
  std::size_t reference_receivers = 0;
};

/// A scene, read and checked: everything finite, in range, triangles not degenerate.
struct Scene {
  std::string name;
  Camera camera;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<MeasuredReflection> measured;  // names differ
  std::vector<Environment> environments;     // at least one; the first is the default
  BakeSettings bake;
  std::size_t dropped_triangles = 0;  // degenerate ones, which are dropped and counted
};

}  // namespace rimlight
