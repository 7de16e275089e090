#include "cli/load_client.h"

#include <algorithm>
#include <deque>
#include <thread>
#include <utility>

#include "core/base/error.h"
#include "core/base/json_reader.h"

namespace rimlight {
namespace {

using Clock = std::chrono::steady_clock;

Clock::duration from_ms(double ms) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::milli>(ms));
}

double to_ms(Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

/// One client's run. The pieces of play(), around their common state.
class Player {
 public:
  Player(const LoadClientSettings& settings, const LoadScript& script)
      : settings_(settings),
        script_(script),
        stream_(settings.url, target(settings), settings.pass) {}

  LoadRecord run() {
    open_ = stream_.send_text(display_message(settings_.codec));
    const Clock::time_point end = settings_.start + from_ms(settings_.seconds * 1e3);
    while (open_ && Clock::now() < end) {
      send_due_edits();
      const Clock::time_point next =
          next_ < script_.edits.size() ? time_of(script_.edits[next_]) : end;
      take(stream_.receive(std::min(next, end)));
    }
    record_.motion_seconds = settings_.seconds;
    const Clock::time_point settled = Clock::now() + from_ms(settings_.settle_seconds * 1e3);
    while (open_ && Clock::now() < settled && !is_settled()) take(stream_.receive(settled));
    // In a shared session another client's last edit may still come.
    const Clock::time_point quiet = Clock::now() + from_ms(kQuietMs);
    while (open_ && Clock::now() < quiet) take(stream_.receive(quiet));
    while (open_ && Clock::now() < settled && !is_settled()) take(stream_.receive(settled));
    stream_.close();
    record_.is_slow = settings_.slow_kBps > 0;
    record_.rungs = frames_.rungs();
    return std::move(record_);
  }

 private:
  static constexpr double kQuietMs = 200;

  struct SentEdit {
    std::int64_t revision = 0;
    Clock::time_point sent;
  };

  static std::string target(const LoadClientSettings& settings) {
    return "/sessions/" + settings.session + "/stream?parts=1" +
           (settings.scene.empty() ? "" : "&scene=" + settings.scene);
  }

  Clock::time_point time_of(const ScriptedEdit& edit) const {
    return settings_.start + from_ms(edit.at_ms);
  }

  void send_due_edits() {
    while (open_ && next_ < script_.edits.size() && time_of(script_.edits[next_]) <= Clock::now()) {
      const std::string id = std::to_string(next_);
      unacknowledged_[id] = last_edit_ = Clock::now();
      open_ = stream_.send_text(edit_message(script_.edits[next_], id));
      ++next_;
      ++record_.edits_sent;
    }
  }

  bool is_settled() const {
    return unacknowledged_.empty() && record_.last_header && record_.last_header->exact &&
           record_.last_header->revision == record_.state_revision;
  }

  void fail(const std::string& what) {
    constexpr std::size_t kMost = 20;
    if (record_.failures.size() < kMost) record_.failures.push_back(what);
  }

  void take(StreamClient::Received received) {
    try {
      if (const auto* const text = std::get_if<StreamClient::Text>(&received)) {
        take_text(text->text);
      } else if (auto* const binary = std::get_if<StreamClient::Binary>(&received)) {
        take_frame(std::move(binary->bytes));
      } else if (const auto* const closed = std::get_if<StreamClient::Closed>(&received)) {
        open_ = false;
        fail("the connection was closed: " + closed->reason);
      }
    } catch (const Error& error) {
      fail(error.what());
    }
  }

  void take_text(const std::string& text) {
    const nlohmann::json document = parse_json(text, "reply");
    const JsonReader reply(document, "reply");
    const std::string type = reply.member("type").string();
    if (type == "error") {
      fail("error reply: " + reply.member("reason").string());
    } else if (type == "ack") {
      take_ack(reply);
    }
    if (type == "welcome") record_.scene = reply.member("scene").string();
    if (type == "welcome" || type == "ack" || type == "state") take_state(reply);
  }

  void take_ack(const JsonReader& reply) {
    const auto sent = unacknowledged_.find(reply.member("id").string());
    if (sent == unacknowledged_.end()) {
      fail("an ack for an edit that was not sent");
      return;
    }
    ++record_.edits_acknowledged;
    unshown_.push_back({reply.member("revision").integer(0, server::kLargestWhole), sent->second});
    unacknowledged_.erase(sent);
  }

  void take_state(const JsonReader& reply) {
    const server::Revision revision{reply.member("epoch").integer(0, server::kLargestWhole),
                                    reply.member("revision").integer(0, server::kLargestWhole)};
    if (revision < record_.state_revision) return;
    record_.state_revision = revision;
    record_.state = server::read_state(reply.member("state"));
  }

  /// A narrow link takes its time for a message, and the acknowledgement comes after it.
  void hold(std::size_t bytes) {
    if (!(settings_.slow_kBps > 0)) return;
    std::this_thread::sleep_for(from_ms(static_cast<double>(bytes) / settings_.slow_kBps));
  }

  void take_frame(const std::vector<std::uint8_t>& bytes) {
    hold(bytes.size());
    const Clock::time_point now = Clock::now();
    const std::int64_t number = server::parse_frame_message(bytes, "frame").header.frame;
    open_ = stream_.send_text(R"({"type":"frame_ack","frame":)" + std::to_string(number) + "}");
    if (auto image = frames_.take(bytes)) show(std::move(*image), bytes.size(), now);
  }

  void show(LoadFrames::Image image, std::size_t bytes, Clock::time_point now) {
    const server::FrameHeader& header = image.header;
    const auto& last = record_.last_header;
    if (last && header.revision < last->revision) record_.revisions_ascend = false;
    // The exact frame may have been seen roughly before, under its number.
    const bool is_seen = last && header.frame == last->frame && header.exact && !last->exact;
    if (last && header.frame <= last->frame && !is_seen) fail("a frame's number does not ascend");
    if (last && !is_seen) record_.skipped += header.frame - last->frame - 1;
    if (header.exact) {
      record_.exact_after_ms = to_ms(now - last_edit_);
    } else if ((!last || header.revision != last->revision) && image.is_changed) {
      ++record_.frames;
      record_.bytes += static_cast<std::int64_t>(bytes);
    } else {
      ++record_.unchanged;
    }
    while (!unshown_.empty() && unshown_.front().revision <= header.revision.number) {
      record_.latencies_ms.push_back(to_ms(now - unshown_.front().sent));
      unshown_.pop_front();
    }
    record_.last_payload = std::move(image.payload);
    record_.last_header = header;
  }

  const LoadClientSettings& settings_;
  const LoadScript& script_;
  StreamClient stream_;
  bool open_ = true;
  std::size_t next_ = 0;
  LoadFrames frames_;
  Clock::time_point last_edit_{};
  std::map<std::string, Clock::time_point> unacknowledged_;
  std::deque<SentEdit> unshown_;  // revisions ascend
  LoadRecord record_;
};

}  // namespace

LoadRecord play(const LoadClientSettings& settings, const LoadScript& script) {
  return Player(settings, script).run();
}

}  // namespace rimlight
