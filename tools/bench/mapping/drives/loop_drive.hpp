#pragma once

#include <optional>

#include "tools/bench/mapping/drives/mapping_drive.hpp"
#include "tools/simulate/town_setup.hpp"

namespace curbstone::bench::mapping::drives {

/// A simulated drive that returns to its start along streets far from each other. It is rendered while it is played,
/// without a log.
class LoopDrive final : public MappingDrive {
 public:
  /// `slips`: wheel slip events per minute.
  LoopDrive(const simulate::TownTour& tour, double slips);

  void play(const Take& take) const override;
  [[nodiscard]] const evaluate::truth::Trajectory& truth() const override { return truth_; }
  [[nodiscard]] Pose T_world_base(std::int64_t utime) const { return setup_.motion().T_world_base(seconds(utime)); }
  /// m driven since the start.
  [[nodiscard]] double way(std::int64_t utime) const { return setup_.motion().profile().distance(seconds(utime)); }
  /// Distance driven, m, until the vehicle is within kNear of a place that it passed at least kApart m earlier. Until
  /// then the pose is dead reckoning without loop closure.
  [[nodiscard]] double returns() const { return returns_; }
  static constexpr double kNear = 60.0;
  static constexpr double kApart = 200.0;
  /// m, one lap.
  [[nodiscard]] double lap() const { return lap_; }
  [[nodiscard]] double length() const { return way(truth_.back().utime); }

 private:
  [[nodiscard]] static double seconds(std::int64_t utime);
  simulate::TownSetup setup_;
  evaluate::truth::Trajectory truth_;
  double lap_;
  double returns_;
};

}  // namespace curbstone::bench::mapping::drives
