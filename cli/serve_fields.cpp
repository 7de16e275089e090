#include "cli/serve_fields.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <iterator>
#include <type_traits>
#include <utility>

namespace rimlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Form = ServeField::Form;

constexpr std::int64_t kLongestSeconds = 86400;
constexpr std::int64_t kMostOfAnything = 100000;
constexpr std::size_t kMostTexts = 100;
constexpr std::size_t kMostBakes = 1000;

// `place` of each is a lambda that gives the member of a ServeConfig, constant or not.

template <typename Place>
ServeField path_field(const char* name, Place place) {
  return {name, Form::path,
          [place](const JsonReader& value, const fs::path& folder, ServeConfig& config) {
            place(config) = folder / value.string();
          },
          [place](const ServeConfig& config) {
            const fs::path& path = place(config);
            return path.empty() ? json() : json(path.string());
          }};
}

template <typename Place>
ServeField text_field(const char* name, Place place) {
  return {name, Form::text,
          [place](const JsonReader& value, const fs::path&, ServeConfig& config) {
            place(config) = value.string();
          },
          [place](const ServeConfig& config) { return json(place(config)); }};
}

template <typename Place>
ServeField texts_field(const char* name, Place place) {
  return {name, Form::texts,
          [place](const JsonReader& value, const fs::path&, ServeConfig& config) {
            std::vector<std::string> texts;
            for (const JsonReader& text : value.elements(0, kMostTexts)) {
              texts.push_back(text.string());
            }
            place(config) = std::move(texts);
          },
          [place](const ServeConfig& config) { return json(place(config)); }};
}

struct Range {
  std::int64_t low, high;
};

template <typename Place>
ServeField whole_field(const char* name, Range range, Place place) {
  return {name, Form::number,
          [place, range](const JsonReader& value, const fs::path&, ServeConfig& config) {
            using Whole = std::remove_reference_t<decltype(place(config))>;
            place(config) = static_cast<Whole>(value.integer(range.low, range.high));
          },
          [place](const ServeConfig& config) { return json(place(config)); }};
}

template <typename Place>
ServeField duration_field(const char* name, Range range, Place place) {
  return {name, Form::number,
          [place, range](const JsonReader& value, const fs::path&, ServeConfig& config) {
            using Duration = std::remove_reference_t<decltype(place(config))>;
            place(config) = Duration(value.integer(range.low, range.high));
          },
          [place](const ServeConfig& config) { return json(place(config).count()); }};
}

template <typename Place>
ServeField flag_field(const char* name, Place place) {
  return {name, Form::flag,
          [place](const JsonReader& value, const fs::path&, ServeConfig& config) {
            place(config) = value.boolean();
          },
          [place](const ServeConfig& config) { return json(place(config)); }};
}

/// A text that `parse` reads, and `write` makes.
template <typename Parse, typename Write>
ServeField parsed_field(const char* name, Parse parse, Write write) {
  return {name, Form::text,
          [parse](const JsonReader& value, const fs::path&, ServeConfig& config) {
            parse(value.string(), value.where(), config);
          },
          [write](const ServeConfig& config) { return json(write(config)); }};
}

ServeField bakes_field() {
  return {"bakes", Form::paths,
          [](const JsonReader& value, const fs::path& folder, ServeConfig& config) {
            std::vector<fs::path> bakes;
            for (const JsonReader& bake : value.elements(1, kMostBakes)) {
              bakes.push_back(folder / bake.string());
            }
            config.bakes = std::move(bakes);
          },
          [](const ServeConfig& config) {
            json bakes = json::array();
            for (const fs::path& bake : config.bakes) bakes.push_back(bake.string());
            return bakes;
          }};
}

ServeField connections_per_address_field() {
  return {"most_connections_per_address", Form::number,
          [](const JsonReader& value, const fs::path&, ServeConfig& config) {
            config.network.most_connections_per_address =
                static_cast<std::size_t>(value.integer(1, kMostOfAnything));
          },
          [](const ServeConfig& config) {
            const auto& most = config.network.most_connections_per_address;
            return most ? json(*most) : json();
          }};
}

ServeField messages_field() {
  return {"messages_per_second", Form::number,
          [](const JsonReader& value, const fs::path&, ServeConfig& config) {
            config.network.messages_per_second = value.number(1, 1e6);
          },
          [](const ServeConfig& config) { return json(config.network.messages_per_second); }};
}

const std::vector<std::string> kLogFormats{"text", "json"};
/// In the order of LightWindow.
const std::vector<std::string> kWindows{"none", "hann", "lanczos", "fitted"};

ServeField log_field() {
  return {"log", Form::text,
          [](const JsonReader& value, const fs::path&, ServeConfig& config) {
            config.log = value.one_of(kLogFormats) == 0 ? LogFormat::text : LogFormat::json;
          },
          [](const ServeConfig& config) {
            return json(kLogFormats[config.log == LogFormat::text ? 0 : 1]);
          }};
}

std::vector<ServeField> network_fields() {
  return {
      text_field(
          "host", [](auto& config) -> auto& { return config.network.host; }),
      whole_field(
          "port", {0, 65535}, [](auto& config) -> auto& { return config.network.port; }),
      path_field(
          "key_file", [](auto& config) -> auto& { return config.key_file; }),
      path_field(
          "tls_certificate", [](auto& config) -> auto& { return config.network.tls.certificate; }),
      path_field(
          "tls_key", [](auto& config) -> auto& { return config.network.tls.key; }),
      flag_field(
          "selftest_echo", [](auto& config) -> auto& { return config.network.selftest_echo; }),
      texts_field(
          "host_names", [](auto& config) -> auto& { return config.network.host_names; }),
      texts_field(
          "origins", [](auto& config) -> auto& { return config.network.origins; }),
      whole_field(
          "network_threads", {1, 64}, [](auto& config) -> auto& { return config.network.threads; }),
      whole_field(
          "most_connections", {1, kMostOfAnything},
          [](auto& config) -> auto& { return config.network.most_connections; }),
      connections_per_address_field(),
      messages_field(),
      duration_field(
          "handshake_timeout_seconds", {1, kLongestSeconds},
          [](auto& config) -> auto& { return config.network.handshake_timeout; }),
      duration_field(
          "idle_timeout_seconds", {1, kLongestSeconds},
          [](auto& config) -> auto& { return config.network.idle_timeout; }),
      duration_field(
          "drain_notice_ms", {0, 2000},
          [](auto& config) -> auto& { return config.network.drain_notice; }),
  };
}

std::vector<ServeField> session_fields() {
  return {
      whole_field(
          "most_sessions", {1, kMostOfAnything},
          [](auto& config) -> auto& { return config.sessions.most_sessions; }),
      duration_field(
          "session_idle_seconds", {0, kLongestSeconds},
          [](auto& config) -> auto& { return config.sessions.idle; }),
      duration_field(
          "quiet_ms", {0, 60000},
          [](auto& config) -> auto& { return config.sessions.session.quiet; }),
      whole_field(
          "jpeg_quality", {1, 100},
          [](auto& config) -> auto& { return config.sessions.session.jpeg_quality; }),
      parsed_field(
          "policy",
          [](const std::string& text, const std::string& where, ServeConfig& config) {
            config.draw.relight.policy = parse_policy(text, where);
          },
          [](const ServeConfig& config) { return policy_name(config.draw.relight.policy); }),
      parsed_field(
          "budget",
          [](const std::string& text, const std::string& where, ServeConfig& config) {
            config.draw.relight.budget = parse_budget(text, where);
          },
          [](const ServeConfig& config) { return budget_name(config.draw.relight.budget); }),
      parsed_field(
          "window",
          [](const std::string& text, const std::string& where, ServeConfig& config) {
            config.draw.vertices.window = parse_window(text, where);
          },
          [](const ServeConfig& config) {
            return kWindows[static_cast<std::size_t>(config.draw.vertices.window)];
          }),
  };
}

std::vector<ServeField> all_fields() {
  std::vector<ServeField> fields{bakes_field(),
                                 path_field(
                                     "web", [](auto& config) -> auto& { return config.web; }),
                                 path_field(
                                     "store", [](auto& config) -> auto& { return config.store; }),
                                 log_field()};
  for (std::vector<ServeField> more : {network_fields(), session_fields()}) {
    std::move(more.begin(), more.end(), std::back_inserter(fields));
  }
  return fields;
}

}  // namespace

std::string ServeField::variable() const {
  std::string result = "RIMLIGHT_";
  for (const char c : name) {
    result += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return result;
}

const std::vector<ServeField>& serve_fields() {
  static const std::vector<ServeField> fields = all_fields();
  return fields;
}

}  // namespace rimlight
