#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/wheel_faults/even_wheels.hpp"
#include "services/ekf/wheel_faults/recent_speeds.hpp"
#include "services/ekf/wheel_faults/wheel_dispute.hpp"
#include "services/ekf/wheel_faults/wheel_evidence.hpp"
#include "services/ekf/wheel_faults/wheel_observation.hpp"

namespace curbstone::ekf::wheel_faults {

/// Detects wheels that are permanently wrong: a broken shaft, an unplugged encoder, or an encoder with another number
/// of counts. Slip ends (SlipJudge); these faults do not, so a faulty wheel is withheld until it has agreed for
/// kAgreement.
///
/// A permanently wrong wheel shows the same multiple of the true speed all the time, and one that no wrong radius
/// explains. Stamp jitter, a wrong track width, and an IMU that has drifted or was hit make wheels disagree too, but
/// not by a constant multiple. Without that proof no wheel is faulty.
///
/// - One of the trusted wheels is refused for more than a third of the time until that adds up to the patience: the
///   others hold the filter, and the wheel is faulty if it shows such a multiple.
/// - All of them are refused for the patience without a break: either they are wrong, or the filter is (WheelDispute).
/// - Both turn evenly while the IMU has measured a change of speed (EvenWheels): both are faulty at once, for as long
///   as they turn evenly.
///
/// Pure; one thread.
class WheelWatch {
 public:
  WheelWatch(const base::SlipConfig& config, double track_width) : config_(config), track_width_(track_width) {}

  void add(const WheelObservation& observation);
  /// Takes every interval of the wheels, also where the filter's belief is too poor for add(). `inertial_speed` and
  /// `noise`: as in EvenWheels. Returns true in the interval in which both are found to be made up.
  [[nodiscard]] bool finds_made_up(const inputs::WheelInterval& interval, double inertial_speed, double noise);
  /// Call it where intervals are missing.
  void interrupt();
  /// The filter has returned to its belief without the wheels: as interrupt(), and the wheels have not pulled it off.
  void on_filter_restored();
  /// What contradicted the wheels was found to be wrong itself: as interrupt(), and they are not made up.
  void pardon();
  /// The vehicle stands: as interrupt(), and its speed is known.
  void on_standstill();

  using Finding = WheelDispute::Finding;
  /// Decides what is wrong after all wheels have been refused for the patience. If the wheels are, they are faulty from
  /// now on. kUndecided: call again after another patience.
  Finding resolve_dispute();

  [[nodiscard]] bool faulty(std::size_t wheel) const { return wheels_[wheel].faulty; }
  [[nodiscard]] bool all_faulty() const { return faulty(0) && faulty(1); }
  /// Both are faulty because they turn evenly whatever the vehicle does.
  [[nodiscard]] bool made_up() const { return made_up_; }
  /// m/s, the vehicle's change of speed by the IMU while they turned evenly.
  [[nodiscard]] double hidden_speed_change() const { return even_.change(); }
  /// A faulty wheel's speed as a multiple of the true one.
  [[nodiscard]] double ratio(std::size_t wheel) const { return wheels_[wheel].evidence.ratio(); }
  /// Whether wheels without travel do not prove a standstill: all trusted wheels are refused while the filter moves, or
  /// all are faulty and one of them does not turn.
  [[nodiscard]] bool standstill_unreliable() const;
  /// How far the wheels that were last found faulty (all of them) may have pulled the filter off since the vehicle
  /// stood.
  [[nodiscard]] const WheelDispute::FilterError& filter_error() const { return filter_error_; }

  static constexpr double kAgreement = 5.0;  ///< s of driving after which a wheel is trusted again
  static constexpr double kFrozen = WheelDispute::kFrozen;

 private:
  struct Wheel {
    bool faulty = false;
    double refused_time = 0.0;  // s, minus half of the time in between; at most the patience
    double agreed_time = 0.0;   // s, since it was found faulty
    WheelEvidence evidence;     // since it was first refused
  };
  void judge_trusted(Wheel& wheel, std::size_t i, const WheelObservation& observation) const;
  void judge_faulty(Wheel& wheel, std::size_t i, const WheelObservation& observation) const;
  void add_evidence(Wheel& wheel, std::size_t i, const WheelObservation& observation) const;
  void dispute(const WheelObservation& observation);
  void end_dispute();

  base::SlipConfig config_;
  double track_width_;  // m
  std::array<Wheel, 2> wheels_;
  std::optional<WheelDispute> dispute_;
  EvenWheels even_;
  bool made_up_ = false;
  RecentSpeeds recent_;
  double distance_ = 0;           // m, driven by the filter's estimate since the vehicle stood, without disputes
  bool filter_restored_ = false;  // since the wheels last agreed
  WheelDispute::FilterError filter_error_;
};

}  // namespace curbstone::ekf::wheel_faults
