#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/report/lit_mesh.h"

namespace rimlight {

/// What a mesh shows as: one material, so that results compare.
struct MeasuredMaterial {
  float albedo = 0.5f;
  float highlight = 0.5f;
  double exponent = 50;
};

/// Vertices calculated in full and adaptively, under lights that turn about the vertical axis while
/// the view stands still.
struct AdaptiveShSettings {
  std::vector<NamedMesh> meshes;
  std::vector<std::shared_ptr<const Environment>> lights;
  std::vector<int> degrees;  // each 1 … sh::kLargestDegree
  MeasuredMaterial material;
  Vec3d eye_direction{0.3, 0.3, 1};
  /// The light stands in so many places around the circle, and in each turns for so many frames.
  int places = 12;
  int frames = 6;
  double step_degrees = 0.5;
  /// In radiance as displayed, 1 = white: the threshold of multi-level filtering (the thesis'
  /// 0.02), and what view transport may leave out.
  float threshold = 0.02f;
  float tolerance = 0.001f;
};

/// One way to calculate, on one mesh under one light to one degree, beside the full calculation.
struct AdaptiveShRow {
  std::string mesh, light, policy;
  int degree = 0;
  std::size_t coefficients = 0;  // (degree + 1)²
  std::size_t vertices = 0, visible = 0;
  double fps_full = 0, fps_adaptive = 0;  // 1 / median time of a frame over visible vertices
  double speedup = 0;                     // median of the ratios of a frame's two times
  double full_of_peak = 0;                // operations of the full calculation a second over peak
  double psnr_db = 0;                     // of vertex colours as displayed, mean over frames
  double least_psnr_db = 0;
  double filtered_diffuse = 0, filtered_specular = 0;
  /// Largest change of a vertex' channel between neighbouring frames beyond the full calculation's
  /// change, as displayed: sRGB in [0, 1].
  double flicker = 0;
  double view_ms = 0;         // to prepare a new view
  double fps_view_moves = 0;  // when every frame is of a new view
};

/// Full calculations below this share of peak are no measure: no speed-up over them is reported.
inline constexpr double kLeastFullOfPeak = 0.6;

/// Rows by mesh, light, degree and policy ("multi-level", "view"). A frame's time is the best of
/// three calculations; those of all policies and of the peak are taken in turn. `progress` gets a
/// name and a share. CheckFailure for an empty list, or a degree out of range; Error of the meshes.
std::vector<AdaptiveShRow> measure_adaptive_sh(
    const AdaptiveShSettings& settings,
    const std::function<void(const std::string& stage, double share)>& progress);

}  // namespace rimlight
