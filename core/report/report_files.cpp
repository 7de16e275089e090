#include "core/report/report_files.h"

#include <fstream>
#include <system_error>
#include <vector>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/parallel.h"

namespace rimlight {
namespace {

using nlohmann::json;

/// The processor's name, as Linux says it.
std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string csv_text(const json& value) {
  if (value.is_array()) {
    std::string text;
    for (const json& part : value) text += (text.empty() ? "" : " ") + part.dump();
    return text;
  }
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  std::string quoted = "\"";
  for (const char c : value.get<std::string>()) {
    quoted += c;
    if (c == '"') quoted += c;
  }
  return quoted + "\"";
}

}  // namespace

json describe_machine() { return {{"processor", processor_name()}, {"threads", thread_count()}}; }

std::string to_csv(const json& rows) {
  std::string text;
  std::vector<std::string> names;
  for (const json& row : rows) {
    if (text.empty()) {
      for (const auto& [name, value] : row.items()) {
        text += (names.empty() ? "" : ",") + name;
        names.push_back(name);
      }
      text += "\n";
    }
    for (const std::string& name : names) {
      if (&name != &names.front()) text += ",";
      text += csv_text(row.at(name));
    }
    text += "\n";
  }
  return text;
}

void write_report(const json& report, const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) throw Error(folder.string(), failure.message(), "a folder to write to");
  const auto name = report.at("experiment").get<std::string>();
  write_file_atomically(folder / (name + ".json"),
                        report.dump(1, ' ', false, json::error_handler_t::replace) + "\n");
  write_file_atomically(folder / (name + ".csv"), to_csv(report.at("rows")));
}

}  // namespace rimlight
