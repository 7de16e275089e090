#include "cli/serve_layers.h"

#include <algorithm>
#include <string_view>

#include "cli/serve_fields.h"
#include "core/base/files.h"

extern char** environ;  // NOLINT: as POSIX declares it

namespace rimlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Form = ServeField::Form;

constexpr std::size_t kLargestConfig = 1 << 20;
constexpr std::string_view kPrefix = "RIMLIGHT_";
/// Names the file itself.
constexpr std::string_view kFileVariable = "RIMLIGHT_CONFIG";

json split(const std::string& text) {
  json parts = json::array();
  for (std::size_t begin = 0; begin <= text.size() && !text.empty();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// A variable's text as a file would have it. What is no number stays a text, which the field then
/// names in its error.
json value_of(const ServeField& field, const std::string& text) {
  switch (field.form) {
    case Form::texts:
    case Form::paths:
      return split(text);
    case Form::number: {
      const json number = json::parse(text, nullptr, /*allow_exceptions=*/false);
      return number.is_number() ? number : json(text);
    }
    case Form::flag: {
      const json flag = json::parse(text, nullptr, /*allow_exceptions=*/false);
      return flag.is_boolean() ? flag : json(text);
    }
    case Form::text:
    case Form::path:
      return text;
  }
  return text;
}

/// An option's name, for errors: --host-name gives an element of host_names.
std::string option_of(const ServeField& field) {
  std::string name = "--" + field.name;
  if (field.form == Form::texts) name.pop_back();
  std::replace(name.begin() + 2, name.end(), '_', '-');
  return name;
}

class Layers {
 public:
  Layers() {
    for (const ServeField& field : serve_fields()) {
      result_.sources[field.name] = ValueSource::built_in;
    }
  }

  void add_file(const fs::path& file) {
    const json document = parse_json(read_file(file, kLargestConfig), file.string());
    const JsonReader reader(document, file.string());
    std::vector<std::string_view> known;
    for (const ServeField& field : serve_fields()) known.push_back(field.name);
    reader.allow_only(known);
    for (const ServeField& field : serve_fields()) {
      if (const auto member = reader.optional_member(field.name)) {
        set(field, *member, file.parent_path(), ValueSource::file);
      }
    }
  }

  void add_environment(const Variables& environment) {
    for (const auto& [variable, text] : environment) {
      if (variable == kFileVariable) continue;
      const auto field = std::find_if(
          serve_fields().begin(), serve_fields().end(),
          [&name = variable](const ServeField& one) { return one.variable() == name; });
      if (field == serve_fields().end()) {
        result_.unknown_variables.push_back(variable);
        continue;
      }
      const json value = value_of(*field, text);
      set(*field, JsonReader(value, variable), {}, ValueSource::environment);
    }
  }

  void add_options(const OptionValues& options) {
    for (const ServeField& field : serve_fields()) {
      const auto found = options.find(field.name);
      if (found == options.end()) continue;
      json value = found->second;
      if (field.form == Form::texts) {
        json all = field.show(result_.config);
        all.insert(all.end(), value.begin(), value.end());
        value = std::move(all);
      }
      set(field, JsonReader(value, option_of(field)), {}, ValueSource::option);
    }
  }

  LayeredConfig finish() && { return std::move(result_); }

 private:
  void set(const ServeField& field, const JsonReader& value, const fs::path& folder,
           ValueSource source) {
    field.read(value, folder, result_.config);
    result_.sources[field.name] = source;
  }

  LayeredConfig result_;
};

}  // namespace

Variables rimlight_variables() {
  Variables result;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    const std::size_t equals = text.find('=');
    if (!text.starts_with(kPrefix) || equals == std::string_view::npos) continue;
    result.emplace(text.substr(0, equals), text.substr(equals + 1));
  }
  return result;
}

const char* to_string(ValueSource source) {
  switch (source) {
    case ValueSource::built_in:
      return "default";
    case ValueSource::file:
      return "file";
    case ValueSource::environment:
      return "environment";
    case ValueSource::option:
      return "option";
  }
  return "default";
}

LayeredConfig layer_config(const fs::path& file, const Variables& environment,
                           const OptionValues& options) {
  Layers layers;
  fs::path named = file;
  if (const auto variable = environment.find(std::string(kFileVariable));
      named.empty() && variable != environment.end()) {
    named = variable->second;
  }
  if (!named.empty()) layers.add_file(named);
  layers.add_environment(environment);
  layers.add_options(options);
  return std::move(layers).finish();
}

ServeConfig read_serve_config(const fs::path& file) {
  Layers layers;
  layers.add_file(file);
  return std::move(layers).finish().config;
}

}  // namespace rimlight
