#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/wheel_faults/even_wheels.hpp"
#include "services/ekf/wheel_faults/recent_speeds.hpp"
#include "services/ekf/wheel_faults/wheel_dispute.hpp"
#include "services/ekf/wheel_faults/wheel_evidence.hpp"
#include "services/ekf/wheel_faults/wheel_look.hpp"

namespace curbstone::ekf::wheel_faults {

/// Wheels that disagree for good: a shaft that is broken, an encoder that is unplugged or counts in other steps. Slip
/// ends (SlipJudge); these do not, so a wheel that is found faulty is withheld until it has agreed for kAgreement.
///
/// What is wrong for good shows the same multiple of the true speed all the time, and one that no wrong radius
/// explains. Stamps that jitter, a track width that is not the configured one, an IMU that has drifted or was hit make
/// wheels disagree too, but not so. Without that proof no wheel is faulty.
///
/// - One of the trusted wheels is refused for more than a third of the time until that adds up to the patience: the
///   filter is held by the others, and the wheel is faulty if it shows such a multiple.
/// - All of them are refused for the patience without a break: either they are wrong, or the filter is (WheelDispute).
/// - Both turn on evenly while the IMU has felt another speed (EvenWheels): both are faulty at once, and are
///   for as long as they turn so.
///
/// Pure; one thread.
class WheelWatch {
 public:
  WheelWatch(const base::SlipConfig& config, double track_width) : config_(config), track_width_(track_width) {}

  void add(const WheelLook& look);
  /// Every interval of the wheels, also where the filter's belief is too poor for add(). `inertial_speed` and
  /// `noise`: as of EvenWheels. True where both are found to be made up with it.
  [[nodiscard]] bool finds_made_up(const inputs::WheelInterval& interval, double inertial_speed, double noise);
  /// The intervals were interrupted.
  void interrupt();
  /// The filter has gone back to what it believed without the wheels: interrupted, and they have not led it astray.
  void restored();
  /// It stands: interrupted, and its speed is known.
  void stand();

  using Finding = WheelDispute::Finding;
  /// Whose fault it is that all wheels have been refused for the patience. If it is theirs, they are faulty from now
  /// on. kNone: ask again after another patience.
  Finding settle();

  [[nodiscard]] bool faulty(std::size_t wheel) const { return wheels_[wheel].faulty; }
  [[nodiscard]] bool all_faulty() const { return faulty(0) && faulty(1); }
  /// Both are faulty because they turn on evenly, whatever the vehicle does.
  [[nodiscard]] bool made_up() const { return made_up_; }
  /// m/s, by which the IMU says that the vehicle has changed its speed while they were.
  [[nodiscard]] double hidden_change() const { return even_.change(); }
  /// The speed that a faulty wheel shows, as a multiple of the true one.
  [[nodiscard]] double ratio(std::size_t wheel) const { return wheels_[wheel].evidence.ratio(); }
  /// Wheels without travel prove nothing: all that are trusted are refused while the filter moves, or all are faulty
  /// and one of them does not turn.
  [[nodiscard]] bool hides_motion() const;
  /// How far wheels that were found faulty last, all of them, may have led the filter astray since it stood.
  [[nodiscard]] const WheelDispute::Astray& astray() const { return astray_; }

  static constexpr double kAgreement = 5.0;  ///< s of driving, after which a wheel is trusted again
  static constexpr double kFrozen = WheelDispute::kFrozen;

 private:
  struct Wheel {
    bool faulty = false;
    double refused = 0.0;    // s, less half of the time in between; at most the patience
    double agreed = 0.0;     // s, since it was found faulty
    WheelEvidence evidence;  // since it was first refused
  };
  void judge_trusted(Wheel& wheel, std::size_t i, const WheelLook& look) const;
  void judge_faulty(Wheel& wheel, std::size_t i, const WheelLook& look) const;
  void collect(Wheel& wheel, std::size_t i, const WheelLook& look) const;
  void dispute(const WheelLook& look);
  void forget_dispute();

  base::SlipConfig config_;
  double track_width_;  // m
  std::array<Wheel, 2> wheels_;
  std::optional<WheelDispute> dispute_;
  EvenWheels even_;
  bool made_up_ = false;
  RecentSpeeds recent_;
  double way_ = 0;         // m, by the filter, since it stood, without disputes
  bool restored_ = false;  // since the wheels agreed last
  WheelDispute::Astray astray_;
};

}  // namespace curbstone::ekf::wheel_faults
