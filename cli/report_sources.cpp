#include "cli/report_sources.h"

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "core/base/error.h"
#include "core/scene/mesh_file.h"

namespace rimlight {

void add_source_options(CLI::App& command, std::vector<std::string>& meshes,
                        std::vector<std::string>& lights) {
  command
      .add_option("--mesh", meshes,
                  "A part of the default scene by name, or a mesh file; repeatable")
      ->capture_default_str();
  command
      .add_option("--light", lights,
                  "A built-in environment by name, or a .hdr or .exr file; repeatable")
      ->capture_default_str();
}

NamedMesh find_mesh(const std::string& name, const Scene& builtin) {
  const std::filesystem::path file(name);
  if (file.has_extension()) {
    return {file.stem().string(), read_mesh_file(file, FileMaterials::ignore).meshes};
  }
  NamedMesh found{name, {}};
  std::ranges::copy_if(builtin.meshes, std::back_inserter(found.meshes),
                       [&](const Mesh& mesh) { return mesh.name == name; });
  if (found.meshes.empty()) {
    throw Error("--mesh", quote(name), "a part of the default scene, or a .obj, .ply or .glb file");
  }
  return found;
}

std::shared_ptr<const Environment> find_light(const std::string& name) {
  if (std::ranges::count(builtin_environment_names(), name) > 0) {
    return std::make_shared<const Environment>(builtin_environment(name));
  }
  const std::filesystem::path file(name);
  if (file.has_extension()) return std::make_shared<const Environment>(load_environment(file));
  std::string names;
  for (const std::string& one : builtin_environment_names()) names += " " + quote(one);
  throw Error("--light", quote(name), "one of" + names + ", or a .hdr or .exr file");
}

std::shared_ptr<const Environment> find_light(const Bake& bake, const std::string& name) {
  for (const BakedEnvironment& one : bake.environments()) {
    if (one.environment->name() == name) return one.environment;
  }
  return find_light(name);
}

}  // namespace rimlight
