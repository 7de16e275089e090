#pragma once

#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace rimlight::server {

enum class Severity { info, warning, error };

/// A field of an event: a number, or a text of which the first 200 bytes are kept. Never a token,
/// a secret, or a request's query.
struct LogField {
  const char* name;
  std::variant<std::int64_t, std::string> value;
};

/// Logs that something happened, through spdlog's default logger: `event` in words with
/// underscores, a literal. Events of one name are bounded (EventAllowance); the next that is logged
/// has the field `suppressed`, how many were not. Any thread; not for what happens with each frame.
void log_event(Severity severity, const char* event, std::initializer_list<LogField> fields);

/// From now on each line of spdlog's default logger is one JSON object: `time` (UTC), `level`,
/// `event` and the event's fields; what is no event has the event "message" and a field of that
/// name. Called once, before other threads log.
void log_as_json();

/// How many events of one name may be logged: 200 at once, 20 a second for long.
class EventAllowance {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr double kBurst = 200;
  static constexpr double kPerSecond = 20;

  /// How many of that name were suppressed since the last that was logged; nothing when this one
  /// is to be, too. `event` must be a literal: names are kept. Any thread.
  std::optional<std::int64_t> take(std::string_view event, Clock::time_point now);

 private:
  struct Bucket {
    double left = kBurst;
    Clock::time_point filled;
    std::int64_t suppressed = 0;
  };
  std::mutex mutex_;
  std::map<std::string_view, Bucket> buckets_;
};

}  // namespace rimlight::server
