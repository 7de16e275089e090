#include "cli/serve_config.h"

#include <system_error>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/json_reader.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestConfig = 1 << 20;
constexpr std::int64_t kLongestSeconds = 86400;

/// Sets `value` from an optional whole-number member.
template <typename T>
void read_whole(const JsonReader& reader, const char* name, std::int64_t low, std::int64_t high,
                T& value) {
  if (const auto member = reader.optional_member(name)) {
    value = static_cast<T>(member->integer(low, high));
  }
}

template <typename Duration>
void read_duration(const JsonReader& reader, const char* name, std::int64_t low, std::int64_t high,
                   Duration& value) {
  if (const auto member = reader.optional_member(name)) {
    value = Duration(member->integer(low, high));
  }
}

/// The texts of an optional array of at most 100.
void read_texts(const JsonReader& reader, const char* name, std::vector<std::string>& texts) {
  constexpr std::size_t kMost = 100;
  if (const auto member = reader.optional_member(name)) {
    for (const JsonReader& text : member->elements(0, kMost)) texts.push_back(text.string());
  }
}

void read_network(const JsonReader& reader, server::NetworkSettings& network) {
  if (const auto host = reader.optional_member("host")) network.host = host->string();
  read_whole(reader, "port", 0, 65535, network.port);
  read_whole(reader, "network_threads", 1, 64, network.threads);
  read_whole(reader, "most_connections", 1, 100000, network.most_connections);
  if (const auto most = reader.optional_member("most_connections_per_address")) {
    network.most_connections_per_address = static_cast<std::size_t>(most->integer(1, 100000));
  }
  if (const auto rate = reader.optional_member("messages_per_second")) {
    network.messages_per_second = rate->number(1, 1e6);
  }
  read_texts(reader, "host_names", network.host_names);
  read_texts(reader, "origins", network.origins);
  read_duration(reader, "handshake_timeout_seconds", 1, kLongestSeconds, network.handshake_timeout);
  read_duration(reader, "idle_timeout_seconds", 1, kLongestSeconds, network.idle_timeout);
}

void read_sessions(const JsonReader& reader, ServeConfig& config) {
  read_whole(reader, "most_sessions", 1, 100000, config.sessions.most_sessions);
  read_duration(reader, "session_idle_seconds", 0, kLongestSeconds, config.sessions.idle);
  read_duration(reader, "quiet_ms", 0, 60000, config.sessions.session.quiet);
  read_whole(reader, "jpeg_quality", 1, 100, config.sessions.session.jpeg_quality);
  if (const auto budget = reader.optional_member("budget")) {
    config.draw.relight.budget = parse_budget(budget->string(), budget->where());
  }
  if (const auto policy = reader.optional_member("policy")) {
    config.draw.relight.policy = parse_policy(policy->string(), policy->where());
  }
  if (const auto window = reader.optional_member("window")) {
    config.draw.vertices.window = parse_window(window->string(), window->where());
  }
}

}  // namespace

ServeConfig read_serve_config(const fs::path& file) {
  const nlohmann::json document = parse_json(read_file(file, kLargestConfig), file.string());
  const JsonReader reader(document, file.string());
  reader.allow_only({"bakes",
                     "web",
                     "host",
                     "port",
                     "network_threads",
                     "most_connections",
                     "idle_timeout_seconds",
                     "most_sessions",
                     "session_idle_seconds",
                     "quiet_ms",
                     "jpeg_quality",
                     "budget",
                     "policy",
                     "window",
                     "store",
                     "key_file",
                     "tls_certificate",
                     "tls_key",
                     "host_names",
                     "origins",
                     "most_connections_per_address",
                     "messages_per_second",
                     "handshake_timeout_seconds"});
  ServeConfig config;
  if (const auto bakes = reader.optional_member("bakes")) {
    for (const JsonReader& bake : bakes->elements(1, 1000)) {
      config.bakes.push_back(file.parent_path() / bake.string());
    }
  }
  if (const auto web = reader.optional_member("web")) {
    config.web = file.parent_path() / web->string();
  }
  if (const auto store = reader.optional_member("store")) {
    config.store = file.parent_path() / store->string();
  }
  if (const auto key = reader.optional_member("key_file")) {
    config.key_file = file.parent_path() / key->string();
  }
  server::TlsFiles& tls = config.network.tls;
  if (const auto certificate = reader.optional_member("tls_certificate")) {
    tls.certificate = file.parent_path() / certificate->string();
  }
  if (const auto key = reader.optional_member("tls_key")) {
    tls.key = file.parent_path() / key->string();
  }
  read_network(reader, config.network);
  read_sessions(reader, config);
  return config;
}

fs::path find_web_folder() {
  constexpr int kLevels = 4;  // beside the program, and up to three folders above
  std::error_code failure;
  const fs::path program = fs::read_symlink("/proc/self/exe", failure);
  fs::path folder = program.parent_path();
  for (int level = 0; level < kLevels && !failure; ++level, folder = folder.parent_path()) {
    for (const char* const place : {"web", "share/rimlight/web"}) {
      std::error_code ignored;
      if (fs::is_regular_file(folder / place / "index.html", ignored)) return folder / place;
    }
  }
  throw Error(program.string(), "no folder web/ near it", "the page's folder: give it with --web");
}

}  // namespace rimlight
