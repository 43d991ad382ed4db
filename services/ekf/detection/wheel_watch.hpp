#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/detection/wheel_evidence.hpp"

namespace curbstone::ekf::detection {

/// Wheels that disagree for good: a shaft that is broken, an encoder that is unplugged or counts in other steps. Slip
/// ends (SlipJudge); these do not, so a wheel that is found faulty is withheld until it has agreed for kAgreement.
///
/// What is wrong for good shows the same multiple of the true speed all the time, and one that no wrong radius
/// explains. Stamps that jitter, a track width that is not the configured one, an IMU that has drifted or was hit make
/// wheels disagree too, but not so. Without that proof no wheel is faulty.
///
/// - One of the trusted wheels is refused for more than a third of the time until that adds up to the patience: the
///   filter is held by the others, and the wheel is faulty if it shows such a multiple.
/// - All of them are refused for the patience without a break: either they are wrong, or the filter is. By how the two
///   came apart settle() says who.
///
/// Pure; one thread.
class WheelWatch {
 public:
  WheelWatch(const base::SlipConfig& config, double track_width) : config_(config), track_width_(track_width) {}

  /// An interval of the wheels while the vehicle drives, and what the filter expected of it.
  struct Look {
    std::int64_t begin = 0;               ///< us
    std::int64_t end = 0;                 ///< us
    std::array<double, 2> speed = {};     ///< m/s, of the wheels, left and right
    std::array<double, 2> expected = {};  ///< m/s, of the wheels, by the filter
    std::array<double, 2> sigma = {};     ///< m/s, 1 sigma of their difference
    std::array<bool, 2> refused = {};     ///< the wheel is taken to slip
    double yaw_rate = 0.0;                ///< rad/s, by the gyro
    double inertial_speed = 0.0;          ///< m/s, integral of forward acceleration since any start
  };
  void add(const Look& look);
  /// The intervals were interrupted.
  void interrupt();
  /// It stands: interrupted, and its speed is known.
  void stand();

  /// Whose fault it is that all wheels have been refused for the patience. If it is theirs, they are faulty from now
  /// on. kNone: either explains it (it speeds up evenly); ask again after another patience.
  enum class Finding { kNone, kWheels, kFilter };
  Finding settle();

  [[nodiscard]] bool faulty(std::size_t wheel) const { return wheels_[wheel].faulty; }
  [[nodiscard]] bool all_faulty() const { return faulty(0) && faulty(1); }
  /// The speed that a faulty wheel shows, as a multiple of the true one.
  [[nodiscard]] double ratio(std::size_t wheel) const { return wheels_[wheel].evidence.ratio(); }
  /// Wheels without travel prove nothing: all that are trusted are refused while the filter moves, or all are faulty
  /// and one of them does not turn.
  [[nodiscard]] bool hides_motion() const;

  /// How far wheels that were found faulty last, all of them, may have led the filter astray since it stood: they pull
  /// it along before they are refused. Those that went wrong at a stroke have not.
  struct Astray {
    double speed = 0.0;    ///< m/s
    double place = 0.0;    ///< m
    double seconds = 0.0;  ///< since they were refused
  };
  [[nodiscard]] const Astray& astray() const { return astray_; }

  static constexpr double kAgreement = 5.0;  ///< s of driving, after which a wheel is trusted again
  static constexpr double kFrozen = 0.02;    ///< of the speed: a wheel that shows less stands still

 private:
  static constexpr std::size_t kParts = 4;
  struct Wheel {
    bool faulty = false;
    double refused = 0.0;    // s, less half of the time in between; at most the patience
    double agreed = 0.0;     // s, since it was found faulty
    WheelEvidence evidence;  // since it was first refused
  };
  using Parts = std::array<WheelEvidence, kParts>;
  /// All trusted wheels have been refused since `begin`.
  struct Dispute {
    std::int64_t begin = 0, end = 0;  // us
    std::array<Parts, 2> parts{};  // of the patience, of each wheel; later, of what was before, and the newest patience
    int undecided = 0;             // times
    double wheels_leapt = 0;       // m/s, more than the IMU
    bool imu_leapt = false;
    double first = 0;  // m/s, mean difference from the filter
    double speed = 0;  // m/s, expected, the newest
  };
  struct Recent {
    double wheels = 0, inertial = 0;  // m/s
  };

  [[nodiscard]] WheelEvidence::Sample sample(const Look& look, std::size_t wheel, std::int64_t since) const;
  void judge_alone(Wheel& wheel, std::size_t i, const Look& look) const;
  void judge_faulty(Wheel& wheel, std::size_t i, const Look& look) const;
  void dispute(const Look& look);
  void remember(const Look& look);
  [[nodiscard]] Finding judge(const Dispute& d) const;
  static void await_more(Dispute& d);
  [[nodiscard]] Astray astray(const Dispute& d) const;
  [[nodiscard]] static WheelEvidence sum(const Parts& parts);

  base::SlipConfig config_;
  double track_width_;  // m
  std::array<Wheel, 2> wheels_;
  std::optional<Dispute> dispute_;
  double way_ = 0;  // m, by the filter, since it stood, without disputes
  Astray astray_;
  std::array<Recent, 3> recent_{};  // newest last
  int remembered_ = 0;
};

}  // namespace curbstone::ekf::detection
