#include "services/ekf/ekf_faults.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace curbstone::ekf {

namespace {

/// "+x" .. "-z": the axis that is nearest to a direction.
std::string axis_along(const Eigen::Vector3d& direction) {
  Eigen::Index axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  return fmt::format("{}{}", direction[axis] < 0 ? '-' : '+', "xyz"[axis]);
}

/// `lean`: rad, to the right and backwards.
std::string lean_in_words(const Eigen::Vector2d& lean) {
  const Eigen::Vector2d degrees = lean * (180 / std::numbers::pi);
  return fmt::format(
      "IMU: by gravity the vehicle leans all along, by {:.0f} deg to the {} and {:.0f} deg {}, and the map leans "
      "with it: correct roll, pitch of vehicle.imu. Or is it on a slope?",
      std::abs(degrees.x()), degrees.x() > 0 ? "right" : "left", std::abs(degrees.y()),
      degrees.y() > 0 ? "backwards" : "forwards");
}

/// `ahead`: the IMU's reading of a force ahead.
std::string mirrored_in_words(const Eigen::Vector2d& ahead) {
  const bool swapped = std::abs(ahead.y()) > std::abs(ahead.x());
  return fmt::format(
      "IMU: its axes are not right-handed: {}, and it is not used. No vehicle.imu is so: correct what the device "
      "sends",
      swapped ? "x and y are swapped" : fmt::format("{} has the wrong sign", ahead.x() > 0 ? 'y' : 'x'));
}

/// `scale`: the wheels' turn as a multiple of the gyro's.
std::string turn_scale_in_words(double scale, const VehicleConfig& vehicle) {
  return fmt::format(
      "WHEELS turn {:.2f} times as far as the gyro: is vehicle.track_width {:.2f} m, or the gyro's scale wrong?", scale,
      scale * vehicle.track_width);
}

std::string missing_yaw_in_words(double yaw, bool is_corrected) {
  return fmt::format("IMU: its forward is not the wheels'{}: add about {:.0f} deg to the yaw of vehicle.imu",
                     is_corrected ? ", and it is used as if turned" : "", yaw * 180 / std::numbers::pi);
}

/// `verdict`: one of mounting.verdicts(), so that its value is there.
std::string in_words(mounting::MountingWatch::Verdict verdict, const mounting::MountingWatch& mounting,
                     const VehicleConfig& vehicle) {
  using Verdict = mounting::MountingWatch::Verdict;
  const auto declared_up = [&] { return axis_along(vehicle.T_base_imu().linear().transpose().col(2)); };
  switch (verdict) {
    case Verdict::kWrongUp:
      return fmt::format(
          "IMU: by gravity its {} axis points up, by vehicle.imu its {}, and it is not used: correct its roll, pitch",
          axis_along(*mounting.wrong_up()), declared_up());
    case Verdict::kWrongGravity:
      return fmt::format(
          "IMU: its mean acceleration is {:.2f} m/s^2, which is not gravity, and it is not used: another unit?",
          *mounting.wrong_gravity());
    case Verdict::kLeans:
      return lean_in_words(*mounting.leans());
    case Verdict::kWheelsCountBackwards:
      return "WHEELS: both count backwards: correct invert_left and invert_right";
    case Verdict::kTurnsOpposite:
      return "WHEELS and gyro turn opposite ways: left and right swapped? Else the gyro's sign is wrong";
    case Verdict::kMirrored:
      return mirrored_in_words(*mounting.mirrored());
    case Verdict::kWrongGyroUp:
      return fmt::format(
          "IMU: its gyro does not turn as the wheels do, and is not used: its {} axis points up, by gravity the {}",
          axis_along(*mounting.wrong_gyro_up()), declared_up());
    case Verdict::kGyroIsWrong:
      return "IMU: its gyro does not turn as the wheels do, and is not used: in deg/s, or another axis up?";
    case Verdict::kWrongTurnScale:
      return turn_scale_in_words(*mounting.wrong_turn_scale(), vehicle);
    case Verdict::kSetsOffTheOtherWay:
      return "IMU: by it the vehicle sets off the other way than by the wheels, and is believed to drive forwards: add "
             "180 deg to the yaw of vehicle.imu, or do both wheels count backwards? The first bend will show it";
    case Verdict::kMissingYaw:
      break;
  }
  return missing_yaw_in_words(*mounting.missing_yaw(), mounting.imu_turn() != 0.0);
}

}  // namespace

void describe_wheels(const wheel_faults::WheelWatch& watch, std::vector<std::string>& faults) {
  if (watch.made_up()) {
    faults.emplace_back(
        "WHEELS: both turn on evenly while the IMU feels another speed, and are not used: does a drive or gateway "
        "repeat an old speed?");
    return;
  }
  for (std::size_t wheel = 0; wheel < 2; ++wheel) {
    if (!watch.faulty(wheel)) continue;
    const double ratio = watch.ratio(wheel);
    std::string what = "stands still";
    if (ratio < -wheel_faults::WheelWatch::kFrozen)
      what = fmt::format("turns backwards, at {:.2f} times the speed", -ratio);
    if (ratio > wheel_faults::WheelWatch::kFrozen) what = fmt::format("turns at {:.2f} times the speed", ratio);
    faults.push_back(fmt::format("WHEELS: the {} wheel is wrong for long ({}) and not used: encoder, plug, shaft?",
                                 wheel == 0 ? "left" : "right", what));
  }
}

void describe_axes(const filter::LostAxes& axes, std::vector<std::string>& faults) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!axes.lost(axis)) continue;
    faults.push_back(fmt::format("IMU: the gyro's {} axis is stuck at {:.4f} rad/s and not used: switch it off and on",
                                 "xyz"[axis], axes.measured_rate()[axis]));
  }
  if (axes.yaw_rate_unmeasured())
    faults.emplace_back("no gyro about the vertical: the wheels tell how it turns, and slip");
}

void describe_noise(const inputs::ShakenImu& imu, const base::NoiseConfig& configured,
                    std::vector<std::string>& faults) {
  constexpr double kMuch = 10.0;  // times
  const auto describe = [&](const char* part, double measured, double expected) {
    if (measured < kMuch * expected) return;
    faults.push_back(
        fmt::format("IMU: its {0} is {1:.0f} times as noisy as ekf.noise.{0} says, and is believed less: "
                    "mount it softer, or set that to {2:.2g}",
                    part, measured / expected, measured));
  };
  const inputs::ImuNoise& noise = imu.noise();
  if (imu.shaken()) {
    faults.push_back(fmt::format(
        "IMU: it is shaken so hard that it is not used: gyro {:.0f}, accelerometer {:.0f} times as noisy as ekf.noise "
        "says. Is its mount loose?",
        noise.gyro() / configured.gyro, noise.accelerometer() / configured.accelerometer));
    return;
  }
  describe("gyro", noise.gyro(), configured.gyro);
  describe("accelerometer", noise.accelerometer(), configured.accelerometer);
}

void describe_leap(const filter::Filter& filter, std::vector<std::string>& faults) {
  constexpr double kMention = 60.0;  // s
  const auto& leapt = filter.gyro_leapt();
  const double ago = leapt ? base::seconds_between(leapt->utime, filter.belief().utime) : kMention;
  if (ago >= kMention) return;
  constexpr std::array kAxes = {"ahead", "left", "the vertical"};
  faults.push_back(fmt::format(
      "IMU: the gyro's bias about {} leapt by {:.1f} deg/s, {:.0f} s ago, and is taken out: is the IMU loose, or its "
      "supply disturbed?",
      kAxes[static_cast<std::size_t>(leapt->axis)], leapt->rate * 180 / std::numbers::pi, ago));
}

void describe_vertical_force(const filter::VerticalForce& vertical, std::vector<std::string>& faults) {
  if (!vertical.wrong()) return;
  faults.push_back(fmt::format(
      "IMU: its accelerometer shows {:.1f} m/s^2 {} that the vehicle does not rise or fall with, and its vertical part "
      "is not used: has its bias leapt, or does it overflow or clip? Mount it softer; switch it off and on",
      std::abs(vertical.excess()), vertical.excess() > 0 ? "upwards" : "downwards"));
}

void describe_mounting(const mounting::MountingWatch& mounting, const VehicleConfig& vehicle,
                       std::vector<std::string>& faults) {
  for (const mounting::MountingWatch::Verdict verdict : mounting.verdicts())
    faults.push_back(in_words(verdict, mounting, vehicle));
}

void describe_imu_outliers(const inputs::ImuOutlierFilter& samples, std::vector<std::string>& faults) {
  constexpr std::size_t kMany = 20;  // per minute: a jolt or two are no fault
  if (samples.rejected_last_minute() < kMany) return;
  faults.push_back(fmt::format(
      "IMU: {} samples within a minute leapt away from those before and after, and are not used: plug, cable, supply?",
      samples.rejected_last_minute()));
}

void describe_accelerometer(const inputs::StuckAccelerometer& accelerometer, std::vector<std::string>& faults) {
  if (!accelerometer.stuck()) return;
  std::string axes;
  for (std::size_t i = 0; i < 3; ++i) {
    if (accelerometer.axes()[i]) axes += axes.empty() ? std::string(1, "xyz"[i]) : fmt::format(", {}", "xyz"[i]);
  }
  faults.push_back(
      fmt::format("IMU: its accelerometer is stuck ({}), and the IMU is not used: switch it off and on", axes));
}

}  // namespace curbstone::ekf
