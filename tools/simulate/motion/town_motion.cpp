#include "tools/simulate/motion/town_motion.hpp"

#include <cmath>

namespace curbstone::simulate::motion {

namespace {

constexpr double kWayStep = 0.125;
constexpr double kNodPerAcceleration = 0.006;   // rad per m/s^2: the nose rises under acceleration
constexpr double kNodTime = 0.1;                // s, over which the springs respond
constexpr double kLeanPerAcceleration = 0.005;  // rad per m/s^2: it leans out of bends

double speed_of(const numerics::Spline<Eigen::Vector2d>& path, double u) {
  return path.derivative(u).norm();
}

/// Path length from a to b, one step of the table or a part of it, by Simpson's rule from the speeds at both.
double way_between(const numerics::Spline<Eigen::Vector2d>& path, double a, double b, double speed_a, double speed_b) {
  return (b - a) / 6.0 * (speed_a + 4.0 * speed_of(path, 0.5 * (a + b)) + speed_b);
}

}  // namespace

TownMotion::TownMotion(const world::Town& town, const VehicleConfig& vehicle, const SpeedProfile& profile,
                       const TownRoute& route)
    : profile_(profile) {
  const world::Ground& ground = town.scene->ground();
  const auto height = [&](const Eigen::Vector2d& p) {
    return static_cast<double>(ground.height_at(static_cast<float>(p.x()), static_cast<float>(p.y())));
  };
  std::vector<State> states;
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < route.size(); ++i) {
    const Eigen::Vector2d p = route.at(i), before = route.at(i - 1), after = route.at(i + 1);
    const Eigen::Vector2d along = (after - before).normalized(), left(-along.y(), along.x());
    const double half_track = 0.5 * vehicle.track_width, half_base = 0.4 * vehicle.length;
    const double zl = height(p + half_track * left), zr = height(p - half_track * left);
    const double zf = height(p + half_base * along), zb = height(p - half_base * along);
    const Eigen::Vector2d bend = (after - 2.0 * p + before) / std::pow(0.5 * (after - before).norm(), 2);
    const double sideways = profile.cruise() * profile.cruise() * left.dot(bend);  // m/s^2, to the left
    State state;
    state << p, 0.5 * (zl + zr), std::atan2(zl - zr, 2.0 * half_track) + kLeanPerAcceleration * sideways,
        -std::atan2(zf - zb, 2.0 * half_base);
    states.push_back(state);
    places.push_back(p);
  }
  path_ = numerics::Spline<State>(states, route.closed());
  line_ = numerics::Spline<Eigen::Vector2d>(places, route.closed());
  way_ = {0.0};
  for (double u = 0; u + 0.5 * kWayStep < path_.length(); u += kWayStep) {
    const double to = u + kWayStep;
    way_.push_back(way_.back() + way_between(line_, u, to, speed_of(line_, u), speed_of(line_, to)));
  }
}

double TownMotion::parameter_at(double s) const {
  const double around = way_.back();
  const double rounds = path_.closed() ? std::floor(s / around) : 0.0;
  const double rest = path_.closed() ? s - rounds * around : std::min(s, around);
  const auto after = std::upper_bound(way_.begin(), way_.end(), rest);
  const auto i = std::min(static_cast<std::size_t>(after - way_.begin()), way_.size() - 1) - 1;
  const double from = static_cast<double>(i) * kWayStep;
  double u = from + kWayStep * (rest - way_[i]) / (way_[i + 1] - way_[i]);
  const double speed_from = speed_of(line_, from);
  for (int k = 0; k < 3; ++k) {
    const double speed_u = speed_of(line_, u);
    u -= (way_[i] + way_between(line_, from, u, speed_from, speed_u) - rest) / speed_u;
  }
  return rounds * path_.length() + u;
}

Pose TownMotion::T_world_base(double t) const {
  const double u = parameter_at(profile_.distance(t));
  const State state = path_.at(u);
  const State along = path_.derivative(u);
  const double turned = profile_.turned(t);
  const double v = profile_.speed(t) / 3.0;
  const double bounce = 1.2e-3 * v * std::sin(2.1 * 6.2832 * t);
  const double rock = 1.5e-3 * v * std::sin(1.3 * 6.2832 * t + 1.0) + 0.5e-3 * v * std::sin(4.7 * 6.2832 * t);
  const double nod = 1.8e-3 * v * std::sin(1.7 * 6.2832 * t + 2.0) + 0.5e-3 * v * std::sin(5.9 * 6.2832 * t);
  // The mean acceleration of that time: a pitch that began at once would be a step to an IMU.
  const double acceleration = std::cos(turned) * (profile_.speed(t) - profile_.speed(t - kNodTime)) / kNodTime;
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(state[0], state[1], state[2] + bounce);
  T.linear() = rotation_from_rpy(state[3] + rock, state[4] - kNodPerAcceleration * acceleration + nod,
                                 std::atan2(along[1], along[0]));
  if (turned != 0.0) T.rotate(Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitZ()));
  return T;
}

}  // namespace curbstone::simulate::motion
