#include "server/metrics/server_metrics.h"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <array>
#include <mutex>
#include <string>
#include <type_traits>

#include "server/metrics/process_use.h"

namespace rimlight::server {
namespace {

using prometheus::Counter;
using prometheus::Gauge;
using prometheus::Histogram;

/// Seconds. A frame at 60 and at 30 a second, and the 150 ms of the last exact frame, are bounds.
const Histogram::BucketBoundaries kSeconds = {
    0.0005, 0.001, 0.002, 0.004, 0.008, 0.0167, 0.0333, 0.05, 0.1, 0.15, 0.25, 0.5, 1, 2.5, 5, 10};

constexpr std::array kKinds = {"moving", "exact"};
/// In the order of Codec.
constexpr std::array kCodecs = {"jpeg", "png", "vp8"};
constexpr std::array kContents = {"frame", "text"};

constexpr double kMillisecond = 1e-3;

double seconds(ServerMetrics::Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

template <typename Enum>
std::size_t index(Enum value) {
  return static_cast<std::size_t>(value);
}

/// All metrics of a family, one for each value of its label.
template <typename Metric, std::size_t kCount>
using Each = std::array<Metric*, kCount>;

class Maker {
 public:
  explicit Maker(prometheus::Registry& registry) : registry_(registry) {}

  Counter* counter(const char* name, const char* help) {
    return &prometheus::BuildCounter().Name(name).Help(help).Register(registry_).Add({});
  }
  Gauge* gauge(const char* name, const char* help) {
    return &prometheus::BuildGauge().Name(name).Help(help).Register(registry_).Add({});
  }
  Histogram* histogram(const char* name, const char* help) {
    return &histograms(name, help).Add({}, kSeconds);
  }
  template <std::size_t kCount>
  Each<Histogram, kCount> histograms_by_kind(const char* name, const char* help,
                                             const std::array<const char*, kCount>& kinds) {
    auto& family = histograms(name, help);
    Each<Histogram, kCount> each{};
    for (std::size_t i = 0; i < kCount; ++i) each[i] = &family.Add({{"kind", kinds[i]}}, kSeconds);
    return each;
  }
  /// `values` are what to_string() or a text says.
  template <typename Value, std::size_t kCount>
  Each<Counter, kCount> counters(const char* name, const char* help, const char* label,
                                 const std::array<Value, kCount>& values) {
    auto& family = prometheus::BuildCounter().Name(name).Help(help).Register(registry_);
    Each<Counter, kCount> each{};
    for (std::size_t i = 0; i < kCount; ++i) {
      if constexpr (std::is_enum_v<Value>) {
        each[i] = &family.Add({{label, to_string(values[i])}});
      } else {
        each[i] = &family.Add({{label, values[i]}});
      }
    }
    return each;
  }
  std::array<Each<Counter, kKinds.size()>, kCodecs.size()> frames(const char* name,
                                                                  const char* help) {
    auto& family = prometheus::BuildCounter().Name(name).Help(help).Register(registry_);
    std::array<Each<Counter, kKinds.size()>, kCodecs.size()> each{};
    for (std::size_t codec = 0; codec < kCodecs.size(); ++codec) {
      for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
        each[codec][kind] = &family.Add({{"codec", kCodecs[codec]}, {"kind", kKinds[kind]}});
      }
    }
    return each;
  }

 private:
  prometheus::Family<Histogram>& histograms(const char* name, const char* help) {
    return prometheus::BuildHistogram().Name(name).Help(help).Register(registry_);
  }

  prometheus::Registry& registry_;
};

}  // namespace

struct ServerMetrics::State {
  std::mutex reading;  // one reader at a time
  prometheus::Registry registry;
  Maker make{registry};

  Each<Histogram, 2> edit_to_frame = make.histograms_by_kind(
      "rimlight_edit_to_frame_seconds",
      "From an edit's arrival to a frame that shows it, ready to be sent", kKinds);
  Each<Histogram, 2> queue_age = make.histograms_by_kind(
      "rimlight_queue_age_seconds", "From when a frame was wanted to when its work began", kKinds);
  Each<Histogram, 2> render = make.histograms_by_kind(
      "rimlight_render_seconds", "Relighting and display of one frame, not its encoding", kKinds);
  Each<Histogram, 2> encode =
      make.histograms_by_kind("rimlight_encode_seconds", "Encoding of one frame", kKinds);
  Histogram* commit = make.histogram("rimlight_store_commit_seconds",
                                     "One commit of the store, flushed; of one or many edits");
  Histogram* durable = make.histogram(
      "rimlight_store_wait_seconds", "From when the oldest edit of a commit came until it is kept");

  std::array<Each<Counter, 2>, kCodecs.size()> frames =
      make.frames("rimlight_frames_total", "Frames that were made");
  Counter* frame_failures =
      make.counter("rimlight_frame_errors_total", "Frames that could not be made");
  Counter* edits = make.counter("rimlight_edits_total", "Edits that were applied");
  Counter* edits_refused = make.counter(
      "rimlight_edits_unstored_total", "Edits that were refused since the store did not keep them");
  Counter* commit_failures =
      make.counter("rimlight_store_errors_total", "Commits of the store that failed");
  Each<Counter, kContents.size()> messages_sent = make.counters(
      "rimlight_sent_messages_total", "WebSocket messages sent", "content", kContents);
  Each<Counter, kContents.size()> bytes_sent = make.counters(
      "rimlight_sent_bytes_total", "Bytes of WebSocket messages sent", "content", kContents);
  Counter* messages_received =
      make.counter("rimlight_received_messages_total", "WebSocket messages received");
  Counter* bytes_received =
      make.counter("rimlight_received_bytes_total", "Bytes of WebSocket messages received");
  Each<Counter, kRefusalReasons.size()> refusals =
      make.counters("rimlight_refusals_total", "Requests, connections and messages not taken",
                    "reason", kRefusalReasons);
  Each<Counter, kCloseReasons.size()> closed = make.counters(
      "rimlight_connections_closed_total", "WebSockets that ended", "outcome", kCloseReasons);

  Gauge* sessions = make.gauge("rimlight_sessions", "Design sessions in memory");
  Gauge* most_sessions = make.gauge("rimlight_sessions_limit", "The bound of rimlight_sessions");
  Gauge* connections = make.gauge("rimlight_connections", "WebSockets that are open");
  Gauge* sockets = make.gauge("rimlight_sockets", "TCP connections that are open, of any use");
  Gauge* most_sockets = make.gauge("rimlight_sockets_limit", "The bound of rimlight_sockets");
  Gauge* scenes = make.gauge("rimlight_scenes", "Scenes that are open");
  Gauge* budget_columns =
      make.gauge("rimlight_budget_columns", "What a frame in motion may cost, where in columns");
  Gauge* budget_bytes =
      make.gauge("rimlight_budget_bytes", "What a frame in motion may cost, where in bytes");
  Gauge* budget_seconds =
      make.gauge("rimlight_budget_seconds", "What a frame in motion may cost, where in time");
  Gauge* overload_stage =
      make.gauge("rimlight_overload_stage",
                 "0 none, 1 smaller budgets, 2 no new sessions, 3 editors before viewers");
  Gauge* budget_share =
      make.gauge("rimlight_budget_share", "What part of its time budget a frame may take now");
  Gauge* lateness = make.gauge("rimlight_lateness_seconds",
                               "How late frames begin, mean of the last half second");
  Gauge* waiting =
      make.gauge("rimlight_store_waiting_edits", "Edits that wait for the disk or are being kept");
  Gauge* waiting_bytes = make.gauge("rimlight_store_waiting_bytes", "Bytes of these");
  Gauge* is_stopping = make.gauge("rimlight_stopping", "1 when the server is about to end");
  Gauge* memory = make.gauge("process_resident_memory_bytes", "Resident memory");
  Counter* cpu = make.counter("process_cpu_seconds_total", "Processor time of all threads");
  Gauge* files = make.gauge("process_open_fds", "File descriptors that are open");
  Gauge* started = make.gauge("process_start_time_seconds", "When it started, in Unix time");
};

ServerMetrics::ServerMetrics() : state_(std::make_unique<State>()) {}
ServerMetrics::~ServerMetrics() = default;

void ServerMetrics::frame_made(const FrameHeader& header) {
  const std::size_t kind = header.exact ? 1 : 0;
  state_->frames[index(header.codec)][kind]->Increment();
  state_->encode[kind]->Observe(header.encode_ms * kMillisecond);
}

void ServerMetrics::frame_drawn(const FrameHeader& header) {
  const std::size_t kind = header.exact ? 1 : 0;
  state_->queue_age[kind]->Observe(header.queue_ms * kMillisecond);
  state_->render[kind]->Observe((header.rotate_ms + header.update_ms + header.display_ms) *
                                kMillisecond);
}

void ServerMetrics::edit_shown(FrameKind kind, Duration since_edit) {
  state_->edit_to_frame[index(kind)]->Observe(seconds(since_edit));
}

void ServerMetrics::frame_failed() { state_->frame_failures->Increment(); }
void ServerMetrics::session_opened() { state_->sessions->Increment(); }
void ServerMetrics::session_closed() { state_->sessions->Decrement(); }
void ServerMetrics::edit_applied() { state_->edits->Increment(); }
void ServerMetrics::edit_refused() { state_->edits_refused->Increment(); }
void ServerMetrics::socket_opened() { state_->sockets->Increment(); }
void ServerMetrics::socket_closed() { state_->sockets->Decrement(); }
void ServerMetrics::connection_opened() { state_->connections->Increment(); }

void ServerMetrics::connection_closed(CloseReason reason) {
  if (reason != CloseReason::handshake_failed) state_->connections->Decrement();
  state_->closed[index(reason)]->Increment();
}

void ServerMetrics::refused(RefusalReason reason) { state_->refusals[index(reason)]->Increment(); }

void ServerMetrics::sent(Content content, std::size_t bytes) {
  state_->messages_sent[index(content)]->Increment();
  state_->bytes_sent[index(content)]->Increment(static_cast<double>(bytes));
}

void ServerMetrics::received(std::size_t bytes) {
  state_->messages_received->Increment();
  state_->bytes_received->Increment(static_cast<double>(bytes));
}

void ServerMetrics::edits_waiting(std::size_t edits, std::size_t bytes) {
  state_->waiting->Set(static_cast<double>(edits));
  state_->waiting_bytes->Set(static_cast<double>(bytes));
}

void ServerMetrics::committed(Duration commit, Duration oldest) {
  state_->commit->Observe(seconds(commit));
  state_->durable->Observe(seconds(oldest));
}

void ServerMetrics::commit_failed() { state_->commit_failures->Increment(); }

void ServerMetrics::serve(const Limits& limits) {
  state_->scenes->Set(static_cast<double>(limits.scenes));
  state_->most_sockets->Set(static_cast<double>(limits.most_sockets));
  state_->most_sessions->Set(static_cast<double>(limits.most_sessions));
  state_->budget_columns->Set(limits.budget_columns);
  state_->budget_bytes->Set(limits.budget_bytes);
  state_->budget_seconds->Set(limits.budget_seconds);
}

void ServerMetrics::overload(int stage, double budget_share, double lateness_ms) {
  state_->overload_stage->Set(stage);
  state_->budget_share->Set(budget_share);
  state_->lateness->Set(lateness_ms * kMillisecond);
}

void ServerMetrics::stopping() { state_->is_stopping->Set(1); }

std::string ServerMetrics::to_text() const {
  const std::lock_guard lock(state_->reading);
  const ProcessUse use = process_use();
  state_->memory->Set(static_cast<double>(use.resident_bytes));
  state_->cpu->Increment(use.cpu_seconds - state_->cpu->Value());
  state_->files->Set(static_cast<double>(use.open_files));
  state_->started->Set(use.started);
  return prometheus::TextSerializer().Serialize(state_->registry.Collect());
}

const std::shared_ptr<ServerMetrics>& unread_metrics() {
  static const auto metrics = std::make_shared<ServerMetrics>();
  return metrics;
}

}  // namespace rimlight::server
