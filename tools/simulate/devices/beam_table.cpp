#include "tools/simulate/devices/beam_table.hpp"

#include <cmath>
#include <numbers>

namespace curbstone::simulate::devices {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Eigen::Vector3d outward(double azimuth_deg) {
  return {std::cos(azimuth_deg * kDegree), -std::sin(azimuth_deg * kDegree), 0.0};
}

}  // namespace

std::vector<double> BeamTable::elevations_deg() const {
  std::vector<double> elevations;
  for (const LaserMount& laser : lasers_) elevations.push_back(laser.elevation);
  return elevations;
}

void BeamTable::beams(double azimuth_deg, std::span<LidarRay> by_laser) const {
  for (std::size_t i = 0; i < lasers_.size(); ++i) {
    const LaserMount& laser = lasers_[i];
    const double head = azimuth_deg + rate_ * laser.time;
    const double up = laser.elevation * kDegree;
    by_laser[i] = {laser.time, lens_offset_ * outward(head) + laser.height * Eigen::Vector3d::UnitZ(),
                   std::cos(up) * outward(head + laser.azimuth) + std::sin(up) * Eigen::Vector3d::UnitZ()};
  }
}

}  // namespace curbstone::simulate::devices
