#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace curbstone::ekf::detection {

/// Detects stuck axes of a gyro: axes that show the same rate, bit for bit, while both others change with each sample.
///
/// Where the gyro's steps are fine, noise makes that impossible in a healthy axis. The noise of a MEMS gyro, 0.005 to
/// 0.01 deg/s/sqrt(Hz), is 0.3 mrad/s or more in 10 Hz of bandwidth; a device that has shown steps of kFine or less
/// repeats a value by chance in a third of the samples, and never kRun times in a row. A coarse gyro (the steps of a
/// WitMotion are 1.07 mrad/s) may repeat for minutes on a smooth floor. There the other two axes must change by
/// kShaking steps from sample to sample for kLong: a vehicle that shakes that much also turns by one step about the
/// third axis.
///
/// Two axes that get stuck in the same moment are detected when the third changes for kPair, if the steps are fine and
/// both axes have changed kMinChanges times before, which excludes a gyro with one axis. A device with a dead zone may
/// show zero on two axes for any time, so zeros count only if a value below kFine has been shown before.
///
/// While all three axes repeat nothing is decided for kPair: the device sends each sample several times. Then all three
/// are stuck, if the steps are fine and all have changed kMinChanges times before. Zeros count only while the wheels
/// turn, as a device may show zero for any time at a standstill, and as above.
///
/// The driver detects, in any gyro, an axis that shows a rate which no bias explains for 0.5 s. Its report is accepted.
///
/// A value type; one thread. Frame imu, rad/s, us.
class GyroWatch {
 public:
  static constexpr double kFine = 3e-4;              ///< rad/s
  static constexpr int kRun = 25;                    ///< samples in which both other axes have changed
  static constexpr double kShaking = 8.0;            ///< steps
  static constexpr std::int64_t kLong = 10'000'000;  ///< us
  static constexpr std::int64_t kPair = 1'000'000;   ///< us
  static constexpr int kMinChanges = 100;            ///< samples
  static constexpr std::int64_t kTrust = 2'000'000;  ///< us of changes after which an axis is trusted again

  /// Adds the next sample and the axes that its driver reports as stuck. `drives`: the wheels turn. After a pause of
  /// more than a second, or where the stamps go back, the runs restart.
  void add(std::int64_t utime, const Eigen::Vector3d& rate, const std::array<bool, 3>& stuck_by_driver = {},
           bool drives = false);
  [[nodiscard]] bool stuck(int axis) const { return axes_[static_cast<std::size_t>(axis)].stuck; }
  /// us, time since which the axis has shown the same rate.
  [[nodiscard]] std::int64_t since(int axis) const { return axes_[static_cast<std::size_t>(axis)].since; }

 private:
  struct Axis {
    bool stuck = false;
    std::int64_t since = 0;                // us
    int repeats = 0;                       // samples in a row
    std::int64_t others_changed = 0;       // of these, samples in which another axis has changed
    std::int64_t both_others_changed = 0;  // of these, samples in which both others have changed
    double smaller_changes = 0.0;          // rad/s, sum over these of the smaller change of the two
    std::int64_t changing_since = 0;       // us, since when it has changed without a long run
    int change_count = 0;                  // number of changes, at most kMinChanges
    std::int64_t others_repeat = 0;        // samples in a row in which both others have repeated
    std::int64_t changed_meanwhile = 0;    // of these, samples in which this axis has changed
  };
  void learn_steps(const Eigen::Vector3d& change);
  void judge(std::size_t axis, std::int64_t utime, const Eigen::Vector3d& change);
  [[nodiscard]] bool is_proven_stuck(const Axis& axis, std::int64_t utime) const;
  void check_pair(std::size_t third, std::int64_t utime, const Eigen::Vector3d& change);
  void check_all(std::int64_t utime, const Eigen::Vector3d& change);
  [[nodiscard]] bool has_fine_steps() const;

  std::array<Axis, 3> axes_;
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
  std::int64_t last_utime_ = 0;
  std::int64_t stood_ = 0;  // us, when the wheels last did not turn
  int all_repeats_ = 0;     // samples in a row in which all axes have repeated, at most kRun
  int fine_changes_ = 0;    // changes by at most kFine, of all axes
  // rad/s, smallest value other than zero that an axis has shown
  double least_ = std::numeric_limits<double>::infinity();
  int changes_ = 0;          // of the current block, all axes
  double block_step_ = 0.0;  // rad/s, the smallest change of the current block
  double step_ = 0.0;        // rad/s, the smallest change of the block before; 0: not known yet
};

}  // namespace curbstone::ekf::detection
