#include "cli/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace rimlight {

ProgressBar::ProgressBar(std::string title)
    : title_(std::move(title)),
      stage_start_(std::chrono::steady_clock::now()),
      terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (terminal_ && !stage_.empty()) std::fputc('\n', stderr);
}

void ProgressBar::show(const std::string& stage, double fraction, bool counts) {
  if (stage != stage_) {
    if (terminal_ && !stage_.empty()) std::fputc('\n', stderr);
    stage_ = stage;
    stage_start_ = std::chrono::steady_clock::now();
    found_done_ = 0;
    last_tenth_ = -1;
  }
  if (!counts) found_done_ = fraction;
  draw(std::clamp(fraction, 0.0, 1.0));
}

std::string ProgressBar::time_left(double fraction) const {
  const double done = fraction - found_done_;
  if (!(done > 0) || fraction >= 1) return "";
  const double spent =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - stage_start_).count();
  const auto seconds = static_cast<long>(std::ceil(spent * (1 - fraction) / done));
  char text[40];
  std::snprintf(text, sizeof text, "%ld:%02ld left", seconds / 60, seconds % 60);
  return text;
}

void ProgressBar::draw(double fraction) {
  constexpr int kWidth = 30;
  const int percent = static_cast<int>(fraction * 100);
  if (terminal_) {
    const int full = static_cast<int>(fraction * kWidth);
    const std::string bar = std::string(static_cast<std::size_t>(full), '#') +
                            std::string(static_cast<std::size_t>(kWidth - full), '.');
    std::fprintf(stderr, "\r%s: %-12s [%s] %3d%% %-14s", title_.c_str(), stage_.c_str(),
                 bar.c_str(), percent, time_left(fraction).c_str());
    std::fflush(stderr);
  } else if (percent / 10 != last_tenth_) {
    last_tenth_ = percent / 10;
    std::fprintf(stderr, "%s: %s %d%% %s\n", title_.c_str(), stage_.c_str(), percent,
                 time_left(fraction).c_str());
  }
}

}  // namespace rimlight
