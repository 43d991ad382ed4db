#include "tools/output/progress_bar.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "common/time/clock.hpp"

namespace curbstone::output {

namespace {

constexpr int kWidth = 30;
constexpr std::int64_t kPeriod = 100'000;  // us

std::string minutes(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::ceil(seconds));
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

std::string progress_line(const std::string& name, double fraction, double elapsed, const std::string& remark) {
  fraction = std::clamp(fraction, 0.0, 1.0);
  const int filled = static_cast<int>(fraction * kWidth);
  std::string line =
      fmt::format("{} [{:#<{}}{:.<{}}] {:3.0f} %", name, "", filled, "", kWidth - filled, 100 * fraction);
  // The first moments do not predict the remaining time.
  if (fraction > 0.01 && elapsed > 1) line += fmt::format("  {} left", minutes(elapsed * (1 / fraction - 1)));
  if (!remark.empty()) line += "  " + remark;
  return line;
}

ProgressBar::ProgressBar(std::string name)
    : name_(std::move(name)), on_terminal_(isatty(STDERR_FILENO) == 1), begin_(steady_clock()) {}

ProgressBar::~ProgressBar() {
  clear();
}

bool ProgressBar::is_due() const {
  return on_terminal_ && steady_clock() - shown_ >= kPeriod;
}

void ProgressBar::show(double fraction, const std::string& remark) {
  if (!is_due()) return;
  const std::int64_t now = shown_ = steady_clock();
  const auto elapsed = static_cast<double>(now - begin_) * 1e-6;
  fmt::print(stderr, "\r\x1b[K{}", progress_line(name_, fraction, elapsed, remark));
}

void ProgressBar::clear() {
  if (shown_ != 0) fmt::print(stderr, "\r\x1b[K");
  shown_ = 0;
}

}  // namespace curbstone::output
