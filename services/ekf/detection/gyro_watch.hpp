#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>

namespace curbstone::ekf::detection {

/// Axes of a gyro that are stuck: they show the same rate, bit for bit, while both others change with each sample.
///
/// Noise makes that impossible where the gyro's steps are fine. A MEMS gyro's noise of 0.005 to 0.01 deg/s/sqrt(Hz) is
/// 0.3 mrad/s and more, in 10 Hz; a device that has shown steps of kFine or less repeats a value by chance in a third
/// of the samples, and kRun times in a row never. A coarse one (the steps of a WitMotion are 1.07 mrad/s) may repeat
/// for minutes on a smooth floor. So the others must show that it shakes, by kShaking of its steps from sample to
/// sample, for kLong: no vehicle that shakes like that does not turn by one step.
///
/// Two axes that get stuck in the same moment are found where the third changes for kPair, if the steps are fine and
/// both have changed kLived times before: so it is no gyro about one axis. Of a device that sets to zero what is small
/// two axes may be zero for as long as they like; so zeros count only where less than kFine has been shown before.
/// Where all repeat nothing is said: it stands, or sends each sample twice.
///
/// The driver finds axes that show a rate which no bias explains for 0.5 s, of any gyro: what it says is believed.
///
/// A value type; one thread. Frame imu, rad/s, us.
class GyroWatch {
 public:
  static constexpr double kFine = 3e-4;              ///< rad/s
  static constexpr int kRun = 25;                    ///< samples in which both others have changed
  static constexpr double kShaking = 8.0;            ///< steps
  static constexpr std::int64_t kLong = 10'000'000;  ///< us
  static constexpr std::int64_t kPair = 1'000'000;   ///< us
  static constexpr int kLived = 100;                 ///< samples
  static constexpr std::int64_t kTrust = 2'000'000;  ///< us of changes after which an axis is believed again

  /// The next sample, and which axes its driver calls stuck. After a pause of more than a second, or where the stamps
  /// go back, runs begin anew.
  void add(std::int64_t utime, const Eigen::Vector3d& rate, const std::array<bool, 3>& stuck_by_driver = {});
  [[nodiscard]] bool stuck(int axis) const { return axes_[static_cast<std::size_t>(axis)].stuck; }
  /// us, since when an axis has shown the same rate.
  [[nodiscard]] std::int64_t since(int axis) const { return axes_[static_cast<std::size_t>(axis)].since; }

 private:
  struct Axis {
    bool stuck = false;
    std::int64_t since = 0;          // us
    int repeats = 0;                 // samples in a row
    std::int64_t moving = 0;         // of these, in which another one has changed
    std::int64_t alone = 0;          // of these, in which both have
    double shaking = 0.0;            // rad/s, sum over these of the smaller change of the two
    std::int64_t moved = 0;          // us, since when it has changed without a long run
    int lived = 0;                   // changes, kLived at most
    std::int64_t others_repeat = 0;  // samples in a row in which both others have shown the same
    std::int64_t goes_on = 0;        // of these, in which this one has changed
  };
  void learn_steps(const Eigen::Vector3d& change);
  void judge(std::size_t axis, std::int64_t utime, const Eigen::Vector3d& change);
  [[nodiscard]] bool proven(const Axis& axis, std::int64_t utime) const;
  void judge_others(std::size_t third, std::int64_t utime, const Eigen::Vector3d& change);

  std::array<Axis, 3> axes_;
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
  std::int64_t last_utime_ = 0;
  int fine_changes_ = 0;     // by kFine at most, of all axes
  double least_ = INFINITY;  // rad/s, that an axis has shown and is not zero
  int changes_ = 0;          // of the present block, of all axes
  double block_step_ = 0.0;  // rad/s, the least of them
  double step_ = 0.0;        // rad/s, the least of the block before; 0: not known yet
};

}  // namespace curbstone::ekf::detection
