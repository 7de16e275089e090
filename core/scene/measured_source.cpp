#include "core/scene/measured_source.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/scene/material_source.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostMeasured = 256;

auto find(const std::vector<MeasuredReflection>& all, const std::string& name) {
  return std::ranges::find(all, name, &MeasuredReflection::name);
}

/// Its name is that of the file where there is none.
MeasuredReflection load(const JsonReader& file, std::string name, const fs::path& folder) {
  const fs::path path = folder / file.string();
  if (name.empty()) name = path.stem().string();
  try {
    return {
        std::move(name), path,
        std::make_shared<const MeasuredLobe>(factorize(*load_measured_brdf(path), path.string()))};
  } catch (const Error& error) {
    throw Error(file.where() + ": " + error.where(), error.found(), error.expected());
  }
}

void add(const JsonReader& where, MeasuredReflection next, std::vector<MeasuredReflection>& all) {
  if (find(all, next.name) != all.end()) {
    throw Error(where.where(), "the name " + quote(next.name) + " twice",
                "a name of its own for each measured BRDF");
  }
  if (all.size() == kMostMeasured) {
    throw Error(where.where(), "one more measured BRDF",
                "at most " + std::to_string(kMostMeasured));
  }
  all.push_back(std::move(next));
}

}  // namespace

std::vector<MeasuredReflection> read_measured_list(const JsonReader& json, const fs::path& folder) {
  std::vector<MeasuredReflection> all;
  for (const JsonReader& element : json.elements(1, kMostMeasured)) {
    if (element.is_string()) {
      add(element, load(element, "", folder), all);
      continue;
    }
    element.allow_only({"file", "name"});
    const auto name = element.optional_member("name");
    add(element, load(element.member("file"), name ? read_name(*name) : "", folder), all);
  }
  return all;
}

const MeasuredReflection& read_measured_of_material(const JsonReader& material,
                                                    const fs::path& folder,
                                                    std::vector<MeasuredReflection>& all) {
  material.allow_only({"model", "measured", "file"});
  if (material.has("measured") == material.has("file")) {
    material.fail("one of \"measured\" and \"file\"");
  }
  if (material.has("measured")) {
    const JsonReader name = material.member("measured");
    const auto found = find(all, name.string());
    if (found == all.end()) name.fail("the name of one of the scene's \"measured\"");
    return *found;
  }
  const JsonReader file = material.member("file");
  const fs::path path = folder / file.string();
  const auto same = std::ranges::find(all, path, &MeasuredReflection::file);
  if (same != all.end()) return *same;
  add(file, load(file, "", folder), all);
  return all.back();
}

}  // namespace rimlight
