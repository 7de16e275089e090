#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/bake/group.h"
#include "core/bake/image_bake.h"
#include "core/light/environment.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// Transport that is ready to be stored.
struct ImportedTransport {
  BakeManifest manifest;                  // all but what storing it finds out
  std::vector<float> coverage;            // [height][width], in [0, 1], somewhere above 0
  std::vector<Environment> environments;  // at least one
  /// The Haar coefficients of the 64 receivers from `first_receiver` on, a group of
  /// manifest.pixels; overwrites all of `coefficients` (of the manifest's cube size). Asked from
  /// any thread, for a group more than once.
  std::function<void(std::size_t first_receiver, GroupRows& coefficients)> rows;
};

struct ImportedBakeSummary {
  std::size_t blocks = 0;    // stored blocks of 8 receivers
  double worst_psnr_db = 0;  // of the compressed transport, over the check lights
  std::string worst_light;
};

/// Compresses transport as bake_image does, such that every check light keeps `psnr_db`, and writes
/// the bake to `folder` (NAME.bake). Receivers without coverage must be black. Throws Error when
/// the disk refuses, or when no compression keeps that error. Does not resume.
///
/// The one place of core/import that knows how bakes are compressed and stored.
ImportedBakeSummary write_imported_bake(const std::filesystem::path& folder,
                                        const ImportedTransport& transport, double psnr_db,
                                        const std::function<void(const BakeProgress&)>& progress);

}  // namespace rimlight
