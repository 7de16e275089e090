#pragma once

#include <atomic>
#include <chrono>

namespace rimlight::server {

using Clock = std::chrono::steady_clock;

/// How far the compute thread is behind, and what is done about it, in stages:
///   smaller_budgets  frames in motion get a share of their time budgets
///   no_new_sessions  and nobody opens another session
///   editors_first    and who may only watch gets no frames in motion
/// From how late jobs begin: its mean over the last half second sets the share of the budgets, its
/// mean over the last two seconds the later stages, each of which ends at half of what began it.
class Overload {
 public:
  enum class Stage { none, smaller_budgets, no_new_sessions, editors_first };
  struct Settings {
    std::chrono::milliseconds comfortable{25};  // budgets are whole up to here
    std::chrono::milliseconds refusing{250};    // no_new_sessions from here
    std::chrono::milliseconds shedding{600};    // editors_first from here
    double least_share = 0.125;
  };

  Overload() = default;
  explicit Overload(const Settings& settings) : settings_(settings) {}

  /// A job that was due at `due` begins now. One thread.
  void begin(Clock::time_point due, Clock::time_point now);

  /// What a frame may take of its time budget: `comfortable` over the mean lateness. Where n
  /// sessions take turns, each waits for the others, so that the share falls with the square root
  /// of n and nothing swings. Any thread.
  double budget_share(Clock::time_point now) const;
  /// Any thread. When no job has begun for two seconds, there is no overload.
  Stage stage(Clock::time_point now) const;
  /// Milliseconds, over the last half second. Any thread.
  double mean_lateness_ms() const { return recent_ms_.load(std::memory_order_relaxed); }

 private:
  bool is_quiet(Clock::time_point now) const;

  const Settings settings_{};
  std::atomic<Clock::duration::rep> last_{0};  // when a job began; 0: none has
  std::atomic<double> recent_ms_{0}, lasting_ms_{0};
  std::atomic<Stage> stage_{Stage::none};  // of the two later ones
};

}  // namespace rimlight::server
