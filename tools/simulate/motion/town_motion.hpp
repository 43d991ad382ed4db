#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/config/vehicle.hpp"
#include "tools/simulate/motion/motion.hpp"
#include "tools/simulate/motion/speed_profile.hpp"
#include "tools/simulate/motion/town_route.hpp"
#include "tools/simulate/numerics/spline.hpp"
#include "tools/simulate/world/town.hpp"

namespace curbstone::simulate::motion {

/// A motion along a route through a town: all wheels on the ground, with roll and pitch from slopes and camber, pitch
/// of the suspension when it accelerates, and slight vibration while it rolls.
class TownMotion final : public Motion {
 public:
  TownMotion(const world::Town& town, const VehicleConfig& vehicle, const SpeedProfile& profile,
             const TownRoute& route);
  /// Around the loop.
  TownMotion(const world::Town& town, const VehicleConfig& vehicle, const SpeedProfile& profile)
      : TownMotion(town, vehicle, profile, TownRoute::around(town)) {}
  [[nodiscard]] Pose T_world_base(double t) const override;
  [[nodiscard]] const SpeedProfile& profile() const { return profile_; }

 private:
  using State = Eigen::Matrix<double, 5, 1>;  // x y z, roll pitch of the ground under the vehicle
  [[nodiscard]] double parameter_at(double s) const;

  numerics::Spline<State> path_;
  numerics::Spline<Eigen::Vector2d> line_;  // its x and y
  SpeedProfile profile_;
  std::vector<double> way_;  // m from the start to places kWayStep apart in the spline's parameter
};

}  // namespace curbstone::simulate::motion
