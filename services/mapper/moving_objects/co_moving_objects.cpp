#include "services/mapper/moving_objects/co_moving_objects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/config/own_body.hpp"

namespace curbstone::mapper::moving_objects {
namespace {

constexpr float kMaxRange = 12;      // m, of an object that matters: beyond it, many other things are in sight
constexpr int kSure = 3;             // looks
constexpr int kMaxEvidence = 6;      // looks
constexpr int kMaxMissed = 2;        // looks
constexpr double kMinChanged = 0.2;  // share of the far ranges that change as the vehicle moves
constexpr float kConnected = 0.8F;   // m between neighbouring returns of one object
constexpr float kInFront = 0.35F;    // m before the object's range: returns from there on are its own,
constexpr float kBehind = 3.0F;      // and up to here, as through its windows
constexpr float kDrift = 0.3F;       // m by which an object's range may change from look to look

}  // namespace

CoMovingObjects::CoMovingObjects(const VehicleConfig& vehicle) : mounting_{vehicle.T_base_lidar(), own_body(vehicle)} {}

std::optional<scan::Scan> CoMovingObjects::without(const scan::Scan& scan, const scan::OdometryHistory& odometry) {
  if (std::abs(scan.end - looked_) >= kLook) look(scan, odometry);
  if (hidden_ == 0) return std::nullopt;
  const Eigen::Isometry3f T_base_lidar = mounting_.T_base_lidar.cast<float>();
  const Eigen::Vector2f lidar = T_base_lidar.translation().head<2>();
  const auto is_of_object = [&](const scan::LidarPoint& point) {
    const Eigen::Vector2f away = (T_base_lidar * point.position).head<2>() - lidar;
    const float range = away.norm();
    if (!(range < kMaxRange + kBehind)) return false;
    const int bin = SurroundView::bin_of(away);
    for (int beside = -1; beside <= 1; ++beside) {
      const Direction& direction = directions_[SurroundView::wrapped(bin + beside)];
      if (direction.until > way_ && range > direction.range - kInFront && range < direction.range + kBehind)
        return true;
    }
    return false;
  };
  std::optional<scan::Scan> rest(scan);
  counters_.add("withheld.co_moving", static_cast<std::int64_t>(std::erase_if(rest->points, is_of_object)));
  return rest;
}

void CoMovingObjects::look(const scan::Scan& scan, const scan::OdometryHistory& odometry) {
  const bool set_back = scan.end < looked_;
  looked_ = scan.end;
  if (set_back || scan.end <= scan.start || !odometry.covers(scan.start, scan.end)) return forget();
  const SurroundView now(scan, mounting_, odometry);
  if (!views_.empty()) way_ += (now.T_odom_base().translation() - views_.back().T_odom_base().translation()).norm();
  while (!views_.empty() && now.utime() - views_.front().utime() > kMaxInterval) views_.pop_front();

  // The latest revolution that is far enough away: an object at almost the same speed has hardly drifted since. And the
  // oldest one: the vehicle has driven past more of the world since.
  const auto is_apart = [&](const SurroundView& then) {
    const Pose motion = then.T_odom_base().inverse() * now.T_odom_base();
    return now.utime() - then.utime() >= kMinInterval &&
           (motion.translation().norm() >= kMinMotion || angle_of(motion) >= kMinTurn);
  };
  std::vector<const SurroundView*> earlier;
  const auto latest = std::find_if(views_.rbegin(), views_.rend(), is_apart);
  if (latest != views_.rend()) earlier.push_back(&*latest);
  if (!earlier.empty() && &views_.front() != earlier.front()) earlier.push_back(&views_.front());
  follow(now);
  if (!earlier.empty()) {
    compare(now, earlier);
    connect(now);
  }
  const auto is_hidden = [&](const Direction& direction) { return direction.until > way_; };
  const int before = std::exchange(
      hidden_, static_cast<int>(std::count_if(directions_.begin(), directions_.end(), is_hidden)) * 360 / kBins);
  if (before == 0 && hidden_ > 0) counters_.add("co_moving");
  if (hidden_ < kFaultFrom) hidden_since_ = now.utime();
  views_.push_back(now);
}

/// Updates the evidence of each direction.
void CoMovingObjects::compare(const SurroundView& now, const std::vector<const SurroundView*>& earlier) {
  int changed = 0, unchanged = 0;  // far ranges
  std::array<bool, kBins> is_same{}, is_evidence{};
  for (int bin = 0; bin < kBins; ++bin) {
    const SurroundView::Return& seen = now.at(bin);
    if (seen.range == 0) continue;
    const auto i = static_cast<std::size_t>(bin);
    for (const SurroundView* then : earlier) {
      if (!now.has_same_range(*then, bin)) continue;
      is_same[i] = true;
      is_evidence[i] = is_evidence[i] || then->sees_through(seen.in_odom) ||
                       (then->at(bin).range != 0 && now.sees_through(then->at(bin).in_odom));
    }
    if (seen.range > kMaxRange) ++(is_same[i] ? unchanged : changed);
  }
  const bool is_moving = changed > kMinChanged * (changed + unchanged);
  for (std::size_t i = 0; i < kBins; ++i) {
    Direction& direction = directions_[i];
    direction.steady = is_same[i] ? direction.steady + 1 : 0;
    if (!is_same[i] || !is_moving)
      direction.evidence = 0;
    else
      direction.evidence = std::clamp(direction.evidence + (is_evidence[i] ? 1 : -1), 0, kMaxEvidence);
  }
}

/// Follows the range of known objects.
void CoMovingObjects::follow(const SurroundView& now) {
  for (int bin = 0; bin < kBins; ++bin) {
    Direction& direction = directions_[static_cast<std::size_t>(bin)];
    if (direction.until <= way_) continue;
    const float range = now.at(bin).range;
    if (now.has_range(bin, direction.range, kDrift)) {
      direction.missed = 0;
      if (range != 0 && std::abs(range - direction.range) <= kDrift) direction.range = range;
    } else if (++direction.missed > kMaxMissed) {
      direction.until = 0;
    }
  }
}

/// Goes through the connected surfaces that keep their range.
void CoMovingObjects::connect(const SurroundView& now) {
  const auto is_steady = [&](int bin) {
    const float range = now.at(bin).range;
    return range != 0 && range <= kMaxRange && directions_[SurroundView::wrapped(bin)].steady >= kSure;
  };
  const auto goes_on = [&](int bin) {
    return is_steady(bin) && is_steady(bin + 1) && (now.at(bin + 1).in_base - now.at(bin).in_base).norm() < kConnected;
  };
  int start = 0;  // a bin at which no surface goes on, if there is one
  while (start < kBins && goes_on(start - 1)) ++start;
  for (int first = start; first < start + kBins;) {
    int last = first;
    while (last + 1 < start + kBins && goes_on(last)) ++last;
    if (is_steady(first)) take_object(now, first, last);
    first = last + 1;
  }
}

/// The surface from bin `first` to `last` is a co-moving object if it has evidence over kMinEvidence m.
void CoMovingObjects::take_object(const SurroundView& now, int first, int last) {
  double evidence = 0;  // m
  for (int bin = first; bin <= last; ++bin) {
    if (directions_[SurroundView::wrapped(bin)].evidence < kSure) continue;
    const int next = bin < last ? bin + 1 : bin - 1;
    if (next >= first) evidence += static_cast<double>((now.at(next).in_base - now.at(bin).in_base).norm());
  }
  if (evidence < kMinEvidence) return;
  for (int bin = first; bin <= last; ++bin) {
    Direction& direction = directions_[SurroundView::wrapped(bin)];
    direction.until = way_ + kForgotten;
    direction.range = now.at(bin).range;
    direction.missed = 0;
  }
}

void CoMovingObjects::forget() {
  views_.clear();
  directions_ = {};
  hidden_ = 0;
}

void CoMovingObjects::add_faults(std::vector<std::string>& faults) const {
  if (hidden_ < kFaultFrom || looked_ - hidden_since_ < kLasting) return;
  faults.push_back(
      fmt::format("LiDAR: something that moves with the vehicle hides {} deg of its round, and is left out: a bus or a "
                  "lorry beside it, a trailer? The map has gaps there",
                  hidden_));
}

}  // namespace curbstone::mapper::moving_objects
