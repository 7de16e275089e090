#include "cli/inspect_parts.h"

#include <array>
#include <cstdio>

namespace rimlight {
namespace {

using nlohmann::json;

/// A JSON object's members, a line each; whatever they are.
void print_members(const char* title, const json& object) {
  std::printf("\n  %s:\n", title);
  for (const auto& [name, value] : object.items()) {
    if (!value.is_object()) {
      std::printf("    %-28s %s\n", printable(name).c_str(), value.dump().c_str());
      continue;
    }
    for (const auto& [of, part] : value.items()) {
      std::printf("    %-28s %s\n", printable(name + ", " + of).c_str(), part.dump().c_str());
    }
  }
}

}  // namespace

std::string printable(const std::string& name) {
  const std::string quoted = json(name).dump();
  return quoted.substr(1, quoted.size() - 2);
}

double mebibytes(const json& bytes) { return bytes.get<double>() / (1 << 20); }

std::string three_numbers(const json& numbers) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.3f %.3f %.3f", numbers[0].get<double>(),
                numbers[1].get<double>(), numbers[2].get<double>());
  return text.data();
}

void describe_files(const std::vector<std::pair<std::string, std::uint64_t>>& files, json& result) {
  std::uint64_t bytes = 0;
  for (const auto& [name, size] : files) {
    result["files"].push_back({{"file", name}, {"bytes", size}});
    bytes += size;
  }
  result["bytes"] = bytes;
}

void describe_environments(const std::vector<BakedEnvironment>& environments, json& result) {
  for (const BakedEnvironment& one : environments) {
    result["environments"].push_back({{"name", one.environment->name()},
                                      {"width", one.environment->image().width},
                                      {"height", one.environment->image().height},
                                      {"exposure_scale", one.exposure_scale}});
  }
}

void print_common(const json& bake) {
  std::printf("\n  file                        MiB\n");
  for (const json& file : bake["files"]) {
    std::printf("  %-24s %8.1f\n", file["file"].get<std::string>().c_str(),
                mebibytes(file["bytes"]));
  }
  std::printf("\n  environments:");
  for (const json& one : bake["environments"]) {
    std::printf(" %s (%d × %d)", one["name"].get<std::string>().c_str(), one["width"].get<int>(),
                one["height"].get<int>());
  }
  std::printf("\n");
  print_members("left out, and what that costs", bake["left_out"]);
  print_members("measured", bake["measured"]);
  print_members("settings", bake["settings"]);
}

}  // namespace rimlight
