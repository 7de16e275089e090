#include "core/base/parallel.h"

#include <pmmintrin.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <xmmintrin.h>

#include <memory>
#include <mutex>

#ifdef RIMLIGHT_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace rimlight {
namespace {

std::mutex control_mutex;
std::unique_ptr<tbb::global_control> control;

/// Tells ThreadSanitizer what it cannot see, for libtbb is not built with it: what was written
/// before a loop is seen by its bodies, and what they wrote is seen after it. Between bodies it
/// tells nothing, so that their races are found. Nothing without the sanitizer.
class LoopOrder {
 public:
  LoopOrder() { release(before_); }
  ~LoopOrder() { acquire(after_); }
  LoopOrder(const LoopOrder&) = delete;
  LoopOrder& operator=(const LoopOrder&) = delete;

  /// Around the bodies that one task runs.
  class Task {
   public:
    explicit Task(LoopOrder& order) : order_(order) { acquire(order_.before_); }
    ~Task() { release(order_.after_); }
    Task(const Task&) = delete;
    Task& operator=(const Task&) = delete;

   private:
    LoopOrder& order_;
  };

 private:
#ifdef RIMLIGHT_THREAD_SANITIZER
  static void acquire(char& place) { __tsan_acquire(&place); }
  static void release(char& place) { __tsan_release(&place); }
#else
  static void acquire(char&) {}
  static void release(char&) {}
#endif
  char before_ = 0;
  char after_ = 0;
};

}  // namespace

void set_thread_count(int threads) {
  const std::lock_guard lock(control_mutex);
  control.reset();
  if (threads > 0) {
    control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    static_cast<std::size_t>(threads));
  }
}

int thread_count() {
  return static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void flush_denormals() {
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  LoopOrder order;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        const LoopOrder::Task task(order);
        flush_denormals();
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
      },
      tbb::simple_partitioner());
}

void run_alone(const std::function<void()>& body) {
  tbb::task_arena arena(1);
  arena.execute([&body] {
    flush_denormals();
    body();
  });
}

}  // namespace rimlight
