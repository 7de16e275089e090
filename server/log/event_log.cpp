#include "server/log/event_log.h"

#include <spdlog/formatter.h>
#include <spdlog/sinks/sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <ctime>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

namespace rimlight::server {
namespace {

constexpr std::size_t kLongestText = 200;
/// The logger whose messages are the fields of an event: how the formatter knows them.
constexpr const char* kEventLogger = "event";

/// Set once: where events go when the log is JSON.
std::shared_ptr<spdlog::logger>& json_logger() {
  static std::shared_ptr<spdlog::logger> logger;
  return logger;
}

spdlog::level::level_enum level_of(Severity severity) {
  switch (severity) {
    case Severity::info:
      return spdlog::level::info;
    case Severity::warning:
      return spdlog::level::warn;
    case Severity::error:
      return spdlog::level::err;
  }
  return spdlog::level::err;
}

nlohmann::json json_of(const LogField& field) {
  if (const auto* const number = std::get_if<std::int64_t>(&field.value)) return *number;
  return std::get<std::string>(field.value).substr(0, kLongestText);
}

/// Invalid UTF-8, as a cut may leave it, becomes a replacement character.
std::string dump(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// "2026-11-22T16:02:26.123Z"
std::string utc(spdlog::log_clock::time_point time) {
  const std::time_t seconds = spdlog::log_clock::to_time_t(time);
  const auto whole = std::chrono::floor<std::chrono::milliseconds>(time.time_since_epoch());
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", parts.tm_year + 1900,
                     parts.tm_mon + 1, parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec,
                     whole.count() % 1000);
}

class JsonFormatter final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) override {
    const auto level = spdlog::level::to_string_view(message.level);
    const std::string_view payload(message.payload.data(), message.payload.size());
    const bool is_event =
        std::string_view(message.logger_name.data(), message.logger_name.size()) == kEventLogger;
    fmt::format_to(std::back_inserter(line), R"({{"time":"{}","level":"{}",)", utc(message.time),
                   std::string_view(level.data(), level.size()));
    if (is_event) {
      line.append(payload.data(), payload.data() + payload.size());
    } else {
      fmt::format_to(std::back_inserter(line), R"("event":"message","message":{})",
                     dump(std::string(payload)));
    }
    constexpr std::string_view kEnd = "}\n";
    line.append(kEnd.data(), kEnd.data() + kEnd.size());
  }
  std::unique_ptr<spdlog::formatter> clone() const override {
    return std::make_unique<JsonFormatter>();
  }
};

/// "connection closed: connection 12, session a": the fields' values as JSON has them where they
/// are not plain words.
std::string text_of(const char* event, const std::initializer_list<LogField>& fields,
                    std::int64_t suppressed) {
  std::string text = event;
  std::replace(text.begin(), text.end(), '_', ' ');
  const char* between = ": ";
  const auto add = [&](const char* name, const nlohmann::json& value) {
    text += between + std::string(name) + " " + dump(value);
    between = ", ";
  };
  for (const LogField& field : fields) add(field.name, json_of(field));
  if (suppressed > 0) add("suppressed", suppressed);
  return text;
}

/// The members of an object, without its braces.
std::string members_of(const char* event, const std::initializer_list<LogField>& fields,
                       std::int64_t suppressed) {
  std::string members = R"("event":)" + dump(event);
  for (const LogField& field : fields) {
    members += "," + dump(field.name) + ":" + dump(json_of(field));
  }
  if (suppressed > 0) members += R"(,"suppressed":)" + std::to_string(suppressed);
  return members;
}

}  // namespace

void log_event(Severity severity, const char* event, std::initializer_list<LogField> fields) {
  static EventAllowance allowance;
  const auto suppressed = allowance.take(event, EventAllowance::Clock::now());
  if (!suppressed) return;
  if (const auto& logger = json_logger()) {
    logger->log(level_of(severity), members_of(event, fields, *suppressed));
  } else {
    spdlog::log(level_of(severity), text_of(event, fields, *suppressed));
  }
}

void log_as_json() {
  const auto& sinks = spdlog::default_logger()->sinks();
  json_logger() = std::make_shared<spdlog::logger>(kEventLogger, sinks.begin(), sinks.end());
  json_logger()->flush_on(spdlog::level::warn);
  for (const auto& sink : sinks) sink->set_formatter(std::make_unique<JsonFormatter>());
}

std::optional<std::int64_t> EventAllowance::take(std::string_view event, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  Bucket& bucket = buckets_.try_emplace(event, Bucket{kBurst, now, 0}).first->second;
  const double passed = std::chrono::duration<double>(now - bucket.filled).count();
  bucket.left = std::min(kBurst, bucket.left + passed * kPerSecond);
  bucket.filled = now;
  if (bucket.left < 1) {
    ++bucket.suppressed;
    return std::nullopt;
  }
  bucket.left -= 1;
  return std::exchange(bucket.suppressed, 0);
}

}  // namespace rimlight::server
