#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/transport/bake_folder.h"

namespace rimlight {

/// What a way to store transport takes, and the error that it leaves.
struct StoragePoint {
  double bytes_per_receiver = 0;
  double worst_psnr_db = 0;  // display-referred, under the worst check light
  std::string worst_light;
};

/// A bake's storage beside the plain way: compressed sparse rows in floats, three values and an
/// index an entry, of the entries with a channel of at least a threshold, the same for all.
struct StorageComparison {
  std::string scene;
  int cube_size = 0;          // N
  std::size_t receivers = 0;  // measured on: those with reference rows
  StoragePoint stored;
  /// By falling threshold: the plain way at all errors.
  std::vector<StoragePoint> csr;
  /// Its bytes at the bake's error, between two thresholds. Infinity when no threshold is as good.
  double csr_bytes_at_stored_error = 0;
};

/// Measures on the bake's reference rows, under the lights that bakes check themselves with. The
/// bake's bytes are those of its runs, their offsets and the reflectance, over the receivers that
/// geometry covers. Throws Error when the bake has no reference rows. Memory: 12 images at 80
/// thresholds of those receivers.
StorageComparison compare_storage(const Bake& bake, const std::function<void(double)>& progress);

}  // namespace rimlight
