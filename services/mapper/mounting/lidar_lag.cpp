#include "services/mapper/mounting/lidar_lag.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/bus/levels.hpp"
#include "common/statistics/consistent_median.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::mounting {
namespace {

constexpr std::int64_t kMaxTurnInterval = 300'000;  // us: largest interval between revolutions whose turns are added up
constexpr int kEstimatePeriod = 10;                 // revolutions between attempts at an estimate
constexpr int kMaxWait = 2400;  // revolutions without an estimate, after which the correlation starts anew
constexpr double kCorrelatedRevolutions = 10;  // consecutive revolutions that count as one: their turns overlap
constexpr std::ptrdiff_t kArm = 3;             // steps to either side of the best one, for the curvature
constexpr double kLagSpread = 0.015;           // s: largest half-width of the middle half of the estimates

double turn_of(const Pose& motion) {
  return std::atan2(motion.linear()(1, 0), motion.linear()(0, 0));
}

std::int64_t lag_at(std::size_t i) {
  return static_cast<std::int64_t>(i) * LidarLag::kStep - LidarLag::kMaxShift;
}

}  // namespace

void LidarLag::Correlation::add(double by_odometry, double by_scans) {
  n += 1;
  x += by_odometry;
  y += by_scans;
  xx += by_odometry * by_odometry;
  xy += by_odometry * by_scans;
  yy += by_scans * by_scans;
}

double LidarLag::Correlation::unexplained() const {
  const double var_x = xx - x * x / n, var_y = yy - y * y / n, cov = xy - x * y / n;
  return var_x > 0 ? std::max(var_y - cov * cov / var_x, 0.0) : var_y;
}

void LidarLag::add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) {
  constexpr std::int64_t kKept = 2 * kMaxShift + kSpan;
  if (!turned_.empty() && (utime <= turned_.back().utime || utime - turned_.back().utime > kMaxTurnInterval))
    interrupt();
  Turned turned{utime};
  if (!turned_.empty()) {
    turned.by_scans = turned_.back().by_scans + turn_of(T_map_base_.inverse() * T_map_base);
    turned.by_odometry = turned_.back().by_odometry + turn_of(T_odom_base_.inverse() * T_odom_base);
  }
  turned_.push_back(turned);
  T_map_base_ = T_map_base;
  T_odom_base_ = T_odom_base;
  if (utime - turned_.front().utime < kKept) return;
  while (utime - turned_[1].utime >= kKept) turned_.pop_front();

  const std::int64_t then = utime - kMaxShift;  // odometry must be known equally long before and after
  const double by_scans = over(&Turned::by_scans, then);
  for (std::size_t i = 0; i < correlations_.size(); ++i)
    correlations_[i].add(over(&Turned::by_odometry, then - lag_at(i)), by_scans);
  if (std::fmod(correlations_.front().n, kEstimatePeriod) == 0) judge();
}

/// The turn over kSpan until `utime`.
double LidarLag::over(double Turned::*by, std::int64_t utime) const {
  const auto at = [&](std::int64_t t) {
    const auto after = std::lower_bound(turned_.begin() + 1, turned_.end() - 1, t,
                                        [](const Turned& turned, std::int64_t time) { return turned.utime < time; });
    const Turned& a = *(after - 1);
    const Turned& b = *after;
    const double share = static_cast<double>(t - a.utime) / static_cast<double>(b.utime - a.utime);
    return a.*by + share * (b.*by - a.*by);
  };
  return at(utime) - at(utime - kSpan);
}

/// The lag with the smallest unexplained part, if that is clearly smaller than at the lags beside it.
std::optional<double> LidarLag::estimate() const {
  const auto less = [](const Correlation& a, const Correlation& b) { return a.unexplained() < b.unexplained(); };
  const auto best = std::min_element(correlations_.begin(), correlations_.end(), less);
  if (best - correlations_.begin() < kArm || correlations_.end() - best <= kArm) return std::nullopt;
  const double before = (best - kArm)->unexplained(), least = best->unexplained(), after = (best + kArm)->unexplained();
  constexpr double kArmSeconds = 1e-6 * kArm * kStep;
  const double bend = (before - 2 * least + after) / (2 * kArmSeconds * kArmSeconds);  // rad^2/s^2
  if (!(bend > 0)) return std::nullopt;
  const double sigma = std::sqrt(kCorrelatedRevolutions * least / best->n / bend);
  if (sigma > kMaxSigma) return std::nullopt;
  const double beside = (before - after) / (4 * kArmSeconds * bend);
  return 1e-6 * static_cast<double>(lag_at(static_cast<std::size_t>(best - correlations_.begin()))) + beside;
}

void LidarLag::judge() {
  const std::optional<double> found = estimate();
  if (found || correlations_.front().n >= kMaxWait)
    std::fill(correlations_.begin(), correlations_.end(), Correlation{});
  if (!found) return;
  estimates_.push_back(*found);
  if (estimates_.size() > kMaxEstimates) estimates_.pop_front();
  const std::optional<double> is = lag();
  if (!is) return;
  const bool was = std::exchange(wrong_, std::abs(*is) > (wrong_ ? kSettled : 1.0) * kWrong);
  if (wrong_ && !was) counters_.add("faults.lidar.late");
  set_level(counters_, "lidar.lag_ms", std::llround(1000 * *is));
}

std::optional<double> LidarLag::lag() const {
  return consistent_median({estimates_.begin(), estimates_.end()}, kLagSpread, kMinEstimates);
}

void LidarLag::add_faults(std::vector<std::string>& faults) const {
  if (!wrong_) return;
  const double seconds = 1e-3 * static_cast<double>(counters_["lidar.lag_ms"]);
  const bool late = seconds > 0;
  faults.push_back(fmt::format(
      "LiDAR: its stamps are {:.0f} ms {} against those of odometry, by how it turns: the map is bent in bends. Is its "
      "clock right (GPS, PTP)? Else set lidar.time_offset {:.3f} s {} than it is; or are the IMU's stamps {}?",
      1000 * std::abs(seconds), late ? "late" : "early", std::abs(seconds), late ? "lower" : "higher",
      late ? "early" : "late"));
}

}  // namespace curbstone::mapper::mounting
