#include "server/schedule/render_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace rimlight::server {
namespace {

using std::chrono::milliseconds;

/// Notes its name, and asks for more work while it wants any.
class Noting : public RenderJob, public std::enable_shared_from_this<Noting> {
 public:
  Noting(int name, std::vector<int>& done, RenderQueue& queue, int wants)
      : name_(name), done_(done), queue_(queue), wants_(wants) {}

  void work(Clock::time_point now) noexcept override {
    done_.push_back(name_);
    if (--wants_ > 0) queue_.schedule(shared_from_this(), now);
  }

 private:
  int name_;
  std::vector<int>& done_;
  RenderQueue& queue_;
  int wants_;
};

TEST(RenderQueue, TakesTheJobThatHasBeenDueLongest) {
  RenderQueue queue;
  std::vector<int> done;
  std::vector<std::shared_ptr<Noting>> jobs;
  const Clock::time_point now{std::chrono::seconds(1000)};
  for (const int late : {30, 10, 20}) {
    jobs.push_back(std::make_shared<Noting>(late, done, queue, 1));
    queue.schedule(jobs.back(), now - milliseconds(late));
  }
  while (queue.run_one(now)) {
  }
  EXPECT_EQ(done, (std::vector<int>{30, 20, 10}));
}

TEST(RenderQueue, ABusyJobDoesNotHoldUpTheOthers) {
  RenderQueue queue;
  std::vector<int> done;
  Clock::time_point now{std::chrono::seconds(1000)};
  const auto busy = std::make_shared<Noting>(1, done, queue, 100);
  const auto other = std::make_shared<Noting>(2, done, queue, 3);
  queue.schedule(busy, now);
  queue.schedule(other, now);
  for (int i = 0; i < 6; ++i) {
    now += milliseconds(5);
    ASSERT_TRUE(queue.run_one(now));
  }
  EXPECT_EQ(std::count(done.begin(), done.end(), 1), 3);
  EXPECT_EQ(std::count(done.begin(), done.end(), 2), 3);
}

TEST(RenderQueue, AJobStandsInItOnceAndNotBeforeItsTime) {
  RenderQueue queue;
  std::vector<int> done;
  const Clock::time_point now{std::chrono::seconds(1000)};
  const auto job = std::make_shared<Noting>(1, done, queue, 1);
  queue.schedule(job, now);
  queue.schedule(job, now + milliseconds(50));
  EXPECT_EQ(queue.next_due(), now + milliseconds(50));
  EXPECT_FALSE(queue.run_one(now + milliseconds(49)));
  EXPECT_TRUE(queue.run_one(now + milliseconds(50)));
  EXPECT_FALSE(queue.run_one(now + milliseconds(50)));
  EXPECT_EQ(done.size(), 1u);
  EXPECT_EQ(queue.next_due(), Clock::time_point::max());
}

TEST(RenderQueue, JobsThatAreGoneOrWithdrawnArePassedOver) {
  RenderQueue queue;
  std::vector<int> done;
  const Clock::time_point now{std::chrono::seconds(1000)};
  const auto withdrawn = std::make_shared<Noting>(1, done, queue, 1);
  queue.schedule(withdrawn, now);
  queue.unschedule(*withdrawn);
  auto gone = std::make_shared<Noting>(2, done, queue, 1);
  queue.schedule(gone, now);
  gone.reset();
  while (queue.run_one(now)) {
  }
  EXPECT_TRUE(done.empty());
}

class Waking : public RenderJob {
 public:
  void work(Clock::time_point) noexcept override { ++runs; }
  std::atomic<int> runs{0};
};

TEST(RenderQueue, TheThreadWakesForEarlierWorkAndStopsWhenAsked) {
  RenderQueue queue;
  const auto late = std::make_shared<Waking>();
  const auto soon = std::make_shared<Waking>();
  queue.schedule(late, Clock::now() + std::chrono::hours(1));
  std::jthread thread([&](const std::stop_token& stop) { queue.run(stop); });
  std::this_thread::sleep_for(milliseconds(20));
  queue.schedule(soon, Clock::now());
  const Clock::time_point deadline = Clock::now() + std::chrono::seconds(5);
  while (soon->runs == 0 && Clock::now() < deadline) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_EQ(soon->runs, 1);
  thread.request_stop();
  thread.join();
  EXPECT_EQ(late->runs, 0);
}

}  // namespace
}  // namespace rimlight::server
