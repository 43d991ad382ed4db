#include "services/ekf/inputs/stamp_smoother.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace curbstone::ekf::inputs {

namespace {

constexpr std::size_t kRecent = 256;         // samples, of which the least late one gives the line's height
constexpr std::size_t kEnough = kRecent;     // samples: fewer are not significant
constexpr std::int64_t kEach = 16;           // samples between two updates
constexpr std::int64_t kMaxLate = 80'000;    // us: a later stamp means a gap, or another rate
constexpr std::int64_t kJump = 1'000'000;    // us: a step of the clock, or one wild stamp
constexpr int kConfirmations = 3;            // consecutive stamps of a clock that jumped
constexpr std::int32_t kMaxLost = 20;        // consecutive samples
constexpr double kSmoothing = 0.1;           // weight of an update of the period
constexpr double kStop = 0.5;                // share of kJitter below which the correction stops
constexpr double kStray = 1.3;               // times as far after 64 samples as after 8: a random walk makes 2.8
constexpr double kGone = 1.6;                // the same while stamps are being changed
constexpr std::size_t kNear = 8, kFar = 64;  // samples

}  // namespace

std::int64_t StampSmoother::add(std::int64_t stamp, std::int32_t sequence) {
  const std::int64_t step = stamp - last_stamp_;
  if (!points_.empty() && std::abs(step) > kJump && ++outliers_ < kConfirmations) return stamp;
  const std::int64_t ahead = std::int64_t{sequence} - sequence_;
  if (!points_.empty() && step == 0 && ahead != 1) return last_out_;  // the same sample again
  if (!points_.empty() && step < 0 && step > -kJump) return stamp;    // out of order: it keeps its own stamp
  outliers_ = 0;
  std::int64_t number = ahead > 1 && ahead <= kMaxLost ? ahead : 1;
  sequence_ = sequence;
  last_stamp_ = stamp;
  if (!points_.empty()) {
    const double expected = period_ > 0 ? period_ * static_cast<double>(number) : 0.0;
    if (step < 0 || static_cast<double>(step) > expected + kMaxLate) restart();
  }
  if (!points_.empty()) number += points_.back().number;
  points_.push_back({number, stamp});
  if (points_.size() > kMemory) points_.pop_front();
  if (points_.size() >= kEnough && number - learnt_at_ >= kEach) learn();
  if (!active_) return last_out_ = stamp;
  const double late = height(points_.back()) - min_height(kRecent);
  if (late > kMaxLate) {
    restart();
    return last_out_ = stamp;
  }
  const auto straight = stamp - std::llround(std::max(late, 0.0));
  const std::int64_t least = last_out_ + std::llround(0.5 * period_);
  return last_out_ = std::min(stamp, std::max<std::int64_t>(straight, least));
}

void StampSmoother::restart() {
  points_.clear();
  learnt_at_ = 0;
  period_ = 0.0;
  active_ = false;
}

void StampSmoother::learn() {
  learnt_at_ = points_.back().number;
  const double now = slope();
  period_ = active_ ? period_ + kSmoothing * (now - period_) : now;
  const double least = min_height(points_.size());
  double mean = 0.0;
  for (const Point& point : points_) mean += (height(point) - least) / static_cast<double>(points_.size());
  active_ = mean > (active_ ? kStop * kJitter : kJitter) && mean < kMaxLate && stays_near();
}

double StampSmoother::height(const Point& point) const {
  const Point& first = points_.front();
  return static_cast<double>(point.stamp - first.stamp) - period_ * static_cast<double>(point.number - first.number);
}

double StampSmoother::min_height(std::size_t samples) const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = points_.size() - std::min(samples, points_.size()); i < points_.size(); ++i)
    least = std::min(least, height(points_[i]));
  return least;
}

/// Slope of the lower convex hull's edge that spans the middle: of all lines below the points it is the nearest.
double StampSmoother::slope() const {
  std::vector<const Point*> hull;
  const auto turns_down = [](const Point& a, const Point& b, const Point& c) {
    return static_cast<double>(b.stamp - a.stamp) * static_cast<double>(c.number - a.number) >=
           static_cast<double>(c.stamp - a.stamp) * static_cast<double>(b.number - a.number);
  };
  for (const Point& point : points_) {
    while (hull.size() > 1 && turns_down(*hull[hull.size() - 2], *hull.back(), point)) hull.pop_back();
    hull.push_back(&point);
  }
  const std::int64_t middle = (points_.front().number + points_.back().number) / 2;
  std::size_t k = 1;
  while (k + 1 < hull.size() && hull[k]->number < middle) ++k;
  return static_cast<double>(hull[k]->stamp - hull[k - 1]->stamp) /
         static_cast<double>(hull[k]->number - hull[k - 1]->number);
}

/// Whether the stamps stay near the line. Jitter returns to the line at once; a drift increases with the lag.
bool StampSmoother::stays_near() const {
  const auto change = [&](std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < points_.size(); ++i) sum += std::abs(height(points_[i]) - height(points_[i - lag]));
    return sum / static_cast<double>(points_.size() - lag);
  };
  return change(kFar) < (active_ ? kGone : kStray) * change(kNear);
}

}  // namespace curbstone::ekf::inputs
