#include "services/ekf/filter/rewinding_filter.hpp"

#include <algorithm>
#include <array>

namespace curbstone::ekf::filter {

namespace {

constexpr std::size_t kPublished = 4096;        // poses: 10 s at 400 Hz
constexpr std::size_t kMaxSamples = 8192;       // bound, whatever the stamps say
constexpr std::int64_t kCheckPoints = 100'000;  // us from one check point to the next

}  // namespace

RewindingFilter::RewindingFilter(const base::EkfConfig& config)
    : history_(static_cast<std::int64_t>(config.timing.history / base::kSecondsPerMicrosecond)),
      filter_(config),
      published_(kPublished) {}

RewindingFilter::Key RewindingFilter::key_of(const Sample& sample) {
  return {std::visit([](const auto& s) { return s.utime; }, sample), sample.index()};
}

Counters RewindingFilter::counters() const {
  Counters all = counters_;
  all.add(filter_.counters());
  return all;
}

void RewindingFilter::add(const Sample& sample, std::vector<model::Estimate>& out) {
  const Key key = key_of(sample);
  static constexpr std::array kNames = {"wheels", "imu", "map"};
  const auto drop = [&](const char* cause) {
    counters_.add(std::string("dropped.") + cause + "." + kNames[key.second]);
  };
  if (!samples_.empty()) {
    const std::int64_t age = samples_.back().first.first - key.first;
    const bool out_of_reach = age > history_ || -age > history_ + kCheckPoints;
    if (out_of_reach && std::holds_alternative<inputs::MapIncrement>(sample)) return drop("late");
    if (out_of_reach) clear_history();
  }
  const auto place = std::upper_bound(samples_.begin(), samples_.end(), key,
                                      [](const Key& k, const auto& entry) { return k < entry.first; });
  if (place != samples_.begin() && std::prev(place)->first == key) return drop("duplicate");
  if (place == samples_.end()) {
    run(sample);
    samples_.emplace_back(key, sample);
  } else {
    if (!(check_points_.front().after < key)) return drop("late");
    counters_.add(std::string("rewound.") + kNames[key.second]);
    samples_.emplace(place, key, sample);
    rewind_to(key);
    continue_from_last_published();
  }
  publish(out);
  drop_old_samples();
}

/// The filter restarts its clock by itself where the stamps require it.
void RewindingFilter::clear_history() {
  last_published_ = INT64_MIN;
  samples_.clear();
  check_points_.clear();
  published_.clear();
}

void RewindingFilter::run(const Sample& sample) {
  std::visit(
      [&](const auto& s) {
        if constexpr (std::is_same_v<std::decay_t<decltype(s)>, inputs::MapIncrement>)
          filter_.add(s);
        else
          filter_.add(s, estimates_);
      },
      sample);
  const Key key = key_of(sample);
  if (check_points_.empty() || key.first - check_points_.back().after.first >= kCheckPoints)
    check_points_.push_back({key, filter_});
}

void RewindingFilter::rewind_to(const Key& late) {
  while (!(check_points_.back().after < late)) check_points_.pop_back();
  filter_ = check_points_.back().filter;
  const auto first = std::upper_bound(samples_.begin(), samples_.end(), check_points_.back().after,
                                      [](const Key& k, const auto& entry) { return k < entry.first; });
  for (auto it = first; it != samples_.end(); ++it) run(it->second);
}

/// Computes the offset from the newest of the new estimates whose time has a published pose.
void RewindingFilter::continue_from_last_published() {
  const auto same_time = std::find_if(estimates_.rbegin(), estimates_.rend(),
                                      [&](const model::Estimate& e) { return published_.at(e.utime).has_value(); });
  if (same_time == estimates_.rend()) return;
  const Pose published = *published_.at(same_time->utime);
  const Pose& filtered = same_time->T_odom_base;
  const double turn = roll_pitch_yaw(published.linear() * filtered.linear().transpose()).z();
  const Pose before = T_odom_filter_;
  T_odom_filter_.linear() = rotation_from_rpy(0, 0, turn);
  T_odom_filter_.translation() = published.translation() - T_odom_filter_.linear() * filtered.translation();
  const Eigen::Vector3d shift = published.translation() - before * filtered.translation();
  const double turned = roll_pitch_yaw(T_odom_filter_.linear() * before.linear().transpose()).z();
  position_shift_ += shift * shift.transpose();
  heading_shift_ += turned * turned;
}

void RewindingFilter::publish(std::vector<model::Estimate>& out) {
  for (model::Estimate& e : estimates_) {
    if (e.utime <= last_published_) continue;
    last_published_ = e.utime;
    e.T_odom_base = T_odom_filter_ * e.T_odom_base;
    const Eigen::Matrix3d turn = T_odom_filter_.linear();
    e.acceleration = turn * e.acceleration;
    Eigen::Matrix<double, 6, 6> to_odom = Eigen::Matrix<double, 6, 6>::Identity();
    to_odom.topLeftCorner<3, 3>() = turn;
    e.pose_covariance = (to_odom * e.pose_covariance * to_odom.transpose()).eval();
    const Eigen::Vector3d up = e.T_odom_base.linear().row(2);
    e.pose_covariance.topLeftCorner<3, 3>() += position_shift_;
    e.pose_covariance.bottomRightCorner<3, 3>() += heading_shift_ * up * up.transpose();
    published_.add(e.utime, e.T_odom_base);
    out.push_back(e);
  }
  estimates_.clear();
}

void RewindingFilter::drop_old_samples() {
  const std::int64_t oldest = samples_.back().first.first - history_;
  while (check_points_.size() > 1 && (check_points_[1].after.first < oldest || samples_.size() > kMaxSamples)) {
    check_points_.pop_front();
    while (samples_.front().first < check_points_.front().after) samples_.pop_front();
  }
}

}  // namespace curbstone::ekf::filter
