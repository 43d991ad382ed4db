#include "tools/calibrate/segment.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace curbstone::calibrate {

namespace {

constexpr double kMaxGap = 0.1;      // s, between samples of one sensor
constexpr double kMinMotion = 0.02;  // rad of a wheel; less is a standstill, which gives no information

template <class Sample>
auto first_at_or_after(const std::vector<Sample>& samples, std::int64_t utime) {
  return std::lower_bound(samples.begin(), samples.end(), utime,
                          [](const Sample& s, std::int64_t t) { return s.utime < t; });
}

ekf::base::WheelSample between(const ekf::base::WheelSample& a, const ekf::base::WheelSample& b, std::int64_t utime) {
  const double f = ekf::base::seconds_between(a.utime, utime) / ekf::base::seconds_between(a.utime, b.utime);
  return {utime, {a.angle[0] + f * (b.angle[0] - a.angle[0]), a.angle[1] + f * (b.angle[1] - a.angle[1])}};
}

ekf::base::ImuSample between(const ekf::base::ImuSample& a, const ekf::base::ImuSample& b, std::int64_t utime) {
  const double f = ekf::base::seconds_between(a.utime, utime) / ekf::base::seconds_between(a.utime, b.utime);
  return {utime, (1.0 - f) * a.angular_rate + f * b.angular_rate, (1.0 - f) * a.acceleration + f * b.acceleration};
}

/// The samples within from..to with interpolated ones at both ends; empty if there is a gap.
template <class Sample>
std::optional<std::vector<Sample>> stretch(const std::vector<Sample>& samples, std::int64_t from, std::int64_t to) {
  auto it = first_at_or_after(samples, from);
  if (it == samples.begin() || it == samples.end()) return std::nullopt;
  std::vector<Sample> out = {between(*std::prev(it), *it, from)};
  if (ekf::base::seconds_between(std::prev(it)->utime, it->utime) > kMaxGap) return std::nullopt;
  for (; it != samples.end() && it->utime < to; ++it) {
    if (ekf::base::seconds_between(out.back().utime, it->utime) > kMaxGap) return std::nullopt;
    if (it->utime > from) out.push_back(*it);
  }
  if (it == samples.end() || ekf::base::seconds_between(out.back().utime, it->utime) > kMaxGap) return std::nullopt;
  out.push_back(it->utime == to ? *it : between(*std::prev(it), *it, to));
  return out;
}

ImuDelta preintegrate(const std::vector<ekf::base::ImuSample>& imu, const Eigen::Vector3d& gyro_bias) {
  ImuDelta out;
  for (std::size_t i = 1; i < imu.size(); ++i) {
    const double dt = ekf::base::seconds_between(imu[i - 1].utime, imu[i].utime);
    const Eigen::Vector3d turn = dt * (0.5 * (imu[i - 1].angular_rate + imu[i].angular_rate) - gyro_bias);
    const Eigen::Vector3d force = 0.5 * (imu[i - 1].acceleration + imu[i].acceleration);
    const Eigen::Vector3d gained = dt * (out.rotation * so3_exp(0.5 * turn) * force);
    out.position += dt * (out.velocity + 0.5 * gained);
    out.velocity += gained;
    const Eigen::Quaterniond step = so3_exp(turn);
    out.rotation_by_bias =
        (step.toRotationMatrix().transpose() * out.rotation_by_bias - dt * Eigen::Matrix3d::Identity()).eval();
    out.rotation = (out.rotation * step).normalized();
  }
  return out;
}

}  // namespace

std::vector<CalibrationSegment> cut_segments(const CalibrationData& data, double duration) {
  std::vector<CalibrationSegment> out;
  std::int64_t last_end = 0;
  for (std::size_t i = 0; i + 1 < data.lidar.size();) {
    const LidarPose& begin = data.lidar[i];
    std::size_t j = i + 1;
    while (j + 1 < data.lidar.size() && ekf::base::seconds_between(begin.utime, data.lidar[j].utime) < duration - 1e-3)
      ++j;
    const LidarPose& end = data.lidar[j];
    i = j;
    CalibrationSegment segment;
    segment.duration = ekf::base::seconds_between(begin.utime, end.utime);
    if (segment.duration < 0.5 * duration || segment.duration > 2.0 * duration) continue;
    const auto wheels = stretch(data.wheels, begin.utime, end.utime);
    const auto imu = stretch(data.imu, begin.utime, end.utime);
    if (!wheels || !imu) continue;
    std::array<double, 2> turned = {};
    for (std::size_t k = 1; k < wheels->size(); ++k) {
      segment.wheels.push_back(
          {(*wheels)[k].angle[0] - (*wheels)[k - 1].angle[0], (*wheels)[k].angle[1] - (*wheels)[k - 1].angle[1]});
      for (std::size_t w = 0; w < 2; ++w) turned[w] += std::abs(segment.wheels.back()[w]);
    }
    if (std::max(turned[0], turned[1]) < kMinMotion) continue;
    segment.T_map_begin = begin.T_map_lidar;
    segment.T_map_end = end.T_map_lidar;
    segment.imu = preintegrate(*imu, data.gyro_bias);
    segment.follows = !out.empty() && last_end == begin.utime;
    last_end = end.utime;
    out.push_back(std::move(segment));
  }
  return out;
}

}  // namespace curbstone::calibrate
