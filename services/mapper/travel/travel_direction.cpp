#include "services/mapper/travel/travel_direction.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "common/statistics/consistent_median.hpp"

namespace curbstone::mapper::travel {
namespace {

constexpr double kSpread = 0.015;  // rad, or share: largest half-width of the middle half of the stretches
constexpr double kTurnSpread = 0.2;

double yaw_of(const Pose& motion) {
  return std::atan2(motion.linear()(1, 0), motion.linear()(0, 0));
}

template <class Values>
void keep(Values& values, typename Values::value_type value) {
  values.push_back(value);
  if (values.size() > TravelDirection::kMaxSamples) values.pop_front();
}

}  // namespace

void TravelDirection::add(const Pose& T_map_base, const Pose& T_odom_base) {
  if (!begin_) begin_ = Place{T_map_base, T_odom_base};
  const Pose moved = begin_->T_map_base.inverse() * T_map_base;
  const Pose odometry = begin_->T_odom_base.inverse() * T_odom_base;
  const double way = moved.translation().head<2>().norm();
  if (const double turn = yaw_of(odometry); std::abs(turn) > kTurn) {
    keep(turns_, yaw_of(moved) / turn);
  } else if (way >= kStretch) {
    const Eigen::Vector3d& a = odometry.translation();
    const Eigen::Vector3d& b = moved.translation();
    // The angle between the two displacements, not from x: it is the same for a vehicle that reverses.
    const double heading_offset = std::atan2(a.x() * b.y() - a.y() * b.x(), a.head<2>().dot(b.head<2>()));
    keep(straights_, {heading_offset, a.head<2>().norm() / way - 1});
  } else {
    return;
  }
  begin_ = Place{T_map_base, T_odom_base};
}

std::optional<TravelDirection::Straight> TravelDirection::straight() const {
  std::vector<double> heading_offset, length_error;
  for (const Straight& stretch : straights_) {
    const double from_first = stretch.heading_offset - straights_.front().heading_offset;  // half a turn: +pi and -pi
    heading_offset.push_back(straights_.front().heading_offset + std::remainder(from_first, 2 * std::numbers::pi));
    length_error.push_back(stretch.length_error);
  }
  const auto direction = consistent_median(std::move(heading_offset), kSpread, kMinSamples);
  const auto length = consistent_median(std::move(length_error), kSpread, kMinSamples);
  if (!direction || !length) return std::nullopt;
  return Straight{std::remainder(*direction, 2 * std::numbers::pi), *length};
}

std::optional<double> TravelDirection::turning() const {
  return consistent_median({turns_.begin(), turns_.end()}, kTurnSpread, kMinSamples);
}

}  // namespace curbstone::mapper::travel
