#include "services/mapper/tracking/way_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curbstone::mapper::tracking {
namespace {

constexpr double kSameWay = 0.06;        // m by which the two ways may differ,
constexpr double kSameShare = 0.15;      // plus this share of the longer one,
constexpr double kSureWay = 4;           // and at least this number of sigmas for a fault
constexpr double kClearlyMore = 1.03;    // factor in agreement by which the scans' way must be better
constexpr double kDirectionFrom = 0.03;  // m, shortest way that has a direction
constexpr double kTellsFrom = 0.12;      // m, shortest way that can end a fault: near standstill both ways always agree
constexpr double kAside = 0.35;          // rad, from which directions differ
constexpr double kSlow = 0.5;            // m/s, speed below which the LiDAR is not believed
constexpr double kGoesOn = 0.3;          // share of its speed by which a vehicle may change meanwhile
constexpr double kDirectionSpread = 0.5;

double to_the_left(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

}  // namespace

void WayCheck::add(const Pair& pair) {
  const double apart = (pair.by_scans - pair.by_odometry).norm();
  const double longer = std::max(pair.by_scans.norm(), pair.by_odometry.norm());
  const bool differ = apart > kSameWay + kSameShare * longer;
  if (differ && (apart < kSureWay * pair.sigma || pair.agreement < kClearlyMore * pair.agreement_with_odometry)) return;
  if (!differ) {
    if (state_ != State::kGood && longer < kTellsFrom) return;
    if (longer >= kTellsFrom) is_new_ = false;
    others_.clear();
    was_ = pair.by_scans / pair.seconds;
    if (++same_ >= kMinPairs) state_ = State::kGood;
    return;
  }
  same_ = 0;
  last_ = pair;
  others_.push_back(pair);
  if (others_.size() > kMinPairs) others_.pop_front();
  if (others_.size() == kMinPairs) decide();
}

/// Decides between a wrong yaw of the LiDAR, which shows the same direction in all pairs, and wrong odometry.
void WayCheck::decide() {
  const State before = state_;
  double sum = 0;
  const double first = to_the_left(others_.front().by_odometry, others_.front().by_scans);
  state_ = State::kDirection;
  for (const Pair& pair : others_) {
    const bool tells = std::min(pair.by_odometry.norm(), pair.by_scans.norm()) > kDirectionFrom;
    const double from_first =
        std::remainder(to_the_left(pair.by_odometry, pair.by_scans) - first, 2 * std::numbers::pi);
    if (!tells || std::abs(from_first) > kDirectionSpread) state_ = State::kDistance;
    sum += from_first;
  }
  aside_ = std::remainder(first + sum / static_cast<double>(others_.size()), 2 * std::numbers::pi);
  if (std::abs(aside_) < kAside) state_ = State::kDistance;
  if (state_ == before) return;
  const double change = (last_.by_scans / last_.seconds - was_).norm();
  goes_on_ = was_.norm() > kSlow && change < kGoesOn * was_.norm();
  counters_.add(state_ == State::kDistance ? "faults.odometry.way" : "faults.lidar.aside");
}

std::optional<double> WayCheck::aside() const {
  return state_ == State::kDirection ? std::optional(aside_) : std::nullopt;
}

void WayCheck::add_faults(std::vector<std::string>& faults, double yaw) const {
  if (apart())
    faults.push_back(fmt::format("ODOMETRY: it goes {:.1f} m/s where the LiDAR sees the vehicle go {:.1f} m/s: {}",
                                 last_.by_odometry.norm() / last_.seconds, last_.by_scans.norm() / last_.seconds,
                                 goes_on_
                                     ? "do the wheels slip, or is an encoder dead? The map goes by the LiDAR alone"
                                     : "do the wheels slip, is an encoder dead, or does something large drive along "
                                       "beside it? The map may be wrong"));
  if (state_ == State::kDirection)
    faults.push_back(
        fmt::format("LiDAR: it sees the vehicle drive {:.0f} deg to the {} of where odometry does: the map is wrong. "
                    "Is it mounted so? "
                    "Then the yaw in vehicle.lidar is {:.2f}, and not {:.2f}; or do the wheels count backwards?",
                    std::abs(aside_) * 180 / std::numbers::pi, aside_ > 0 ? "left" : "right",
                    std::remainder(yaw - aside_, 2 * std::numbers::pi), yaw));
}

}  // namespace curbstone::mapper::tracking
