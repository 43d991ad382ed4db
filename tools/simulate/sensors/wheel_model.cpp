#include "tools/simulate/sensors/wheel_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curbstone::simulate::sensors {

WheelModel::WheelModel(const WheelNoise& noise, const VehicleConfig& vehicle, const motion::Motion& motion,
                       double seconds, numerics::Random random)
    : noise_(noise), motion_(motion), half_track_(0.5 * vehicle.track_width) {
  for (auto& radius : radius_)
    radius = vehicle.wheel_radius * (1.0 + std::clamp(random.normal(noise.radius_error), -0.005, 0.005));
  // Slip occurs when the speed changes: finds the times of acceleration and braking, and picks some of them.
  const auto way = [&](double t) { return motion::rolled_distance(motion, Eigen::Vector3d::Zero(), t, t + 0.1); };
  std::vector<double> moments;
  for (double t = 0; t + 0.6 < seconds; t += 0.25) {
    if (std::abs(way(t + 0.3) - way(t)) > 0.01) moments.push_back(t);
  }
  const auto count = static_cast<int>(std::lround(noise.slips_per_minute * seconds / 60.0));
  for (int i = 0; i < count && !moments.empty(); ++i) {
    const double from = moments[static_cast<std::size_t>(random.integer(0, static_cast<int>(moments.size()) - 1))];
    const bool gains = way(from + 0.3) > way(from);  // a driven wheel spins, a braked one locks
    slips_.push_back({from, from + random.uniform(0.15, 0.45), random.integer(0, 2), gains ? noise.slip : -noise.slip});
  }
}

double WheelModel::slip_at(double t, int wheel) const {
  double share = 0;
  for (const auto& slip : slips_) {
    if (t >= slip.from && t < slip.to && (slip.wheel == 2 || slip.wheel == wheel)) share = slip.share;
  }
  return share;
}

void WheelModel::roll_to(double t) {
  constexpr double kStep = 0.01;  // s
  while (t_ < t) {
    const double next = std::min(t, t_ + kStep);
    const std::array<double, 2> rolled = motion::rolled_distances(
        motion_, {Eigen::Vector3d(0, half_track_, 0), Eigen::Vector3d(0, -half_track_, 0)}, t_, next);
    for (int wheel = 0; wheel < 2; ++wheel) {
      const auto i = static_cast<std::size_t>(wheel);
      const double turned = rolled[i] / radius_[i] * (1.0 + slip_at(t_, wheel));
      angle_[i] += turned;
      speed_[i] = turned / (next - t_);
    }
    t_ = next;
  }
}

std::array<std::int64_t, 2> WheelModel::counts(double t) {
  roll_to(t);
  const double per_radian = noise_.counts_per_revolution / (2.0 * std::numbers::pi);
  return {static_cast<std::int64_t>(std::floor(angle_[0] * per_radian)),
          static_cast<std::int64_t>(std::floor(angle_[1] * per_radian))};
}

}  // namespace curbstone::simulate::sensors
