#pragma once

#include <chrono>
#include <string>

namespace rimlight {

/// A bar on standard error with the time left: redrawn in place on a terminal, else a line for each
/// tenth of a stage. One thread.
class ProgressBar {
 public:
  explicit ProgressBar(std::string title);
  ~ProgressBar();

  /// `counts` is false for work that was found done already: it does not tell how fast the rest
  /// goes.
  void show(const std::string& stage, double fraction, bool counts = true);

 private:
  void draw(double fraction);
  std::string time_left(double fraction) const;

  std::string title_;
  std::string stage_;
  std::chrono::steady_clock::time_point stage_start_;
  double found_done_ = 0;  // the share of the stage that took no time
  int last_tenth_ = -1;
  bool terminal_;
};

}  // namespace rimlight
