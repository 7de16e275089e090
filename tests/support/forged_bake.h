#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "core/base/files.h"
#include "core/transport/bake_manifest.h"
#include "core/transport/tensor_file.h"
#include "tests/support/overwrite.h"

namespace rimlight::test {

/// Writes a manifest with its hash, as somebody with an editor and xxh64sum could.
inline void forge_manifest(const std::filesystem::path& folder, const std::string& text) {
  overwrite(folder / kManifestFile, text);
  overwrite(folder / kManifestHashFile, manifest_hash_line(text));
}

/// Replaces one tensor file with `bytes`, manifest and hashes made to match.
inline void forge_file(const std::filesystem::path& folder, const std::string& name,
                       const std::string& bytes) {
  overwrite(folder / name, bytes);
  TensorFileSummary summary{bytes.size(), {}};
  const auto all = std::as_bytes(std::span(bytes));
  for (std::size_t begin = 0; begin < all.size(); begin += kHashedBlock) {
    const auto block = all.subspan(begin, std::min(kHashedBlock, all.size() - begin));
    summary.block_hashes.push_back(hash_bytes(block, summary.block_hashes.size()));
  }
  auto manifest = nlohmann::json::parse(read_file(folder / kManifestFile, SIZE_MAX));
  manifest["files"][name] = summary.to_json();
  forge_manifest(folder, manifest.dump());
}

}  // namespace rimlight::test
