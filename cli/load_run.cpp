#include "cli/load_run.h"

#include <chrono>
#include <exception>
#include <random>
#include <thread>

namespace rimlight {
namespace {

LoadScript part_of(const LoadRun& run, std::size_t client) {
  if (!run.shared_session) return run.script;
  LoadScript part;
  const bool has_slow = run.slow_kBps > 0 && run.clients > 1;
  const auto editors = static_cast<std::size_t>(run.clients - (has_slow ? 1 : 0));
  for (std::size_t i = client; client < editors && i < run.script.edits.size(); i += editors) {
    part.edits.push_back(run.script.edits[i]);
  }
  return part;
}

}  // namespace

std::vector<LoadRecord> play_run(const LoadRun& run) {
  constexpr double kSettleSeconds = 10;
  const std::string name = "load-" + std::to_string(std::random_device{}());
  const auto count = static_cast<std::size_t>(run.clients);
  const auto start = std::chrono::steady_clock::now() + std::chrono::milliseconds(300);
  std::vector<LoadRecord> records(count);
  std::vector<std::exception_ptr> failures(count);
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < count; ++i) {
      threads.emplace_back([&, i] {
        try {
          const std::string session = run.shared_session ? name : name + "-" + std::to_string(i);
          const double slow_kBps = i + 1 == count ? run.slow_kBps : 0;
          const LoadClientSettings settings{run.url,        run.pass,  session,
                                            run.scene,      start,     run.seconds,
                                            kSettleSeconds, run.codec, slow_kBps};
          records[i] = play(settings, part_of(run, i));
        } catch (...) {
          failures[i] = std::current_exception();
        }
      });
    }
  }
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
  return records;
}

}  // namespace rimlight
