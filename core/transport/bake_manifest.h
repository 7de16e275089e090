#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/json_reader.h"
#include "core/light/environment.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// The fields of BakeManifest as they stand in manifest.json, and back. Reading throws Error at the
/// first field that is missing, unknown (but "files" and "environments") or out of range.
nlohmann::json manifest_to_json(const BakeManifest& manifest);
BakeManifest read_manifest(const JsonReader& json);

// What manifests of all kinds share. Reading throws Error at the field.

/// Throws Error unless the manifest is of this kind.
void expect_kind(const JsonReader& manifest, const std::string& expected);
nlohmann::json camera_to_json(const Camera& camera);
Camera read_manifest_camera(const JsonReader& json);
/// "width" or "height" of a picture.
int read_image_side(const JsonReader& json);
/// An object for people, as it is.
nlohmann::json read_object(const JsonReader& json);

/// The text of manifest.json, found to match the hash beside it; throws Error naming the file.
std::string read_manifest_text(const std::filesystem::path& folder);
/// What stands in the hash file: one line as xxh64sum writes it, so that `xxh64sum -c` checks it.
std::string manifest_hash_line(const std::string& manifest_text);

const char* layout_name(EnvironmentLayout layout);
EnvironmentLayout read_layout(const JsonReader& json);

/// A file's name inside a bake's folder, and nothing else: letters, digits, '.', '_', '-'; not
/// starting with '.'.
bool is_plain_file_name(const std::string& name);

}  // namespace rimlight
