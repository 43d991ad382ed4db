#include "tools/bench/mapping/drives/poor_odometry.hpp"

#include <algorithm>

#include "services/mapper/scan/deskew.hpp"

namespace curbstone::bench::mapping::drives {
namespace {

constexpr std::int64_t kPeriod = 10'000;  // us

Pose steady_pose(const evaluate::truth::Trajectory& truth, std::int64_t t) {
  const auto after =
      std::upper_bound(truth.begin() + 1, truth.end() - 1, t,
                       [](std::int64_t at, const evaluate::truth::StampedPose& p) { return at < p.utime; });
  const evaluate::truth::StampedPose& from = *(after - 1);
  const double fraction = static_cast<double>(t - from.utime) / static_cast<double>(after->utime - from.utime);
  return from.pose * mapper::scan::move(mapper::scan::twist_of(from.pose.inverse() * after->pose, 1.0), fraction);
}

}  // namespace

std::vector<mapper::scan::OdometrySample> poor_odometry(const evaluate::truth::Trajectory& truth,
                                                        const OdometryErrors& errors, std::int64_t beyond) {
  std::vector<mapper::scan::OdometrySample> out;
  Pose T_odom_base = Pose::Identity();
  std::int64_t t = truth.front().utime - beyond;
  Pose before = steady_pose(truth, t);
  for (; t < truth.back().utime + beyond; t += kPeriod) {
    const Pose now = steady_pose(truth, t);
    mapper::scan::Twist motion = mapper::scan::twist_of(before.inverse() * now, 1.0);
    motion.linear *= errors.scale;
    motion.angular.z() += errors.yaw_rate * 1e-6 * static_cast<double>(kPeriod);
    T_odom_base = normalised(T_odom_base * mapper::scan::move(motion, 1.0));
    before = now;
    out.push_back({t, T_odom_base, true, false});
  }
  return out;
}

}  // namespace curbstone::bench::mapping::drives
