// An IMU that is wrong for a sample now and then, or whose accelerometer has got stuck: odometry goes on as if it had
// sent nothing.
#include <algorithm>
#include <random>

#include "tests/services/ekf/ekf_node_test.hpp"
#include "tests/services/ekf/ground_error.hpp"
#include "tests/services/ekf/town_drive.hpp"

namespace curbstone::ekf {
namespace {

class BadImu : public EkfNodeTest {
 protected:
  /// Drives through a town while `spoil` may change each sample. Returns the largest error on the ground, m.
  double run(Rig& rig, const std::function<void(base::ImuSample&, double seconds)>& spoil) {
    const Drive drive = simulate_town_drive({.seconds = 60.0}, config_.vehicle);
    for (std::size_t i = 0; i < drive.imu.size(); ++i) {
      base::ImuSample imu = drive.imu[i];
      spoil(imu, base::seconds_between(drive.imu.front().utime, imu.utime));
      if (i < drive.wheels.size()) rig.send("WHEELS", message_of(drive.wheels[i], static_cast<std::int32_t>(i)));
      rig.send("IMU", message_of(imu, static_cast<std::int32_t>(i)));
    }
    rig.finish();
    const std::size_t start = drive.index_of(rig.odometry.front().utime);
    double most = 0.0;
    for (const odometry_t& message : rig.odometry) {
      const Pose truth = drive.T_odom_base(std::min(drive.index_of(message.utime), drive.truth.size() - 1), start);
      const Pose pose = pose_from_arrays(message.position, message.orientation);
      most = std::max(most, (pose.translation() - truth.translation()).head<2>().norm());
    }
    std::printf("[ figure ] at most %.2f m off in 60 s\n", most);
    return most;
  }
};

TEST_F(BadImu, SamplesThatStandAloneDoNotTurnIt) {
  for (const double share : {0.0003, 0.003, 0.01}) {
    for (const double leap : {2.0, 6.0, 34.0}) {
      Rig rig(config_);
      std::mt19937 engine(5);
      std::int64_t bad = 0;
      const double most = run(rig, [&](base::ImuSample& imu, double) {
        if (std::uniform_real_distribution<double>()(engine) >= share) return;
        imu.angular_rate[static_cast<Eigen::Index>(bad % 3)] += bad % 2 == 0 ? leap : -leap;
        ++bad;
      });
      EXPECT_LT(most, 1.0) << share << " " << leap;
      EXPECT_NEAR(static_cast<double>(rig.node.report().counters["refused.lone.imu"]), static_cast<double>(bad),
                  0.1 * static_cast<double>(bad));
      EXPECT_EQ(rig.node.report().counters["launches.disowned"], 0);
    }
  }
}

TEST_F(BadImu, NorDoTheyMakeItDisownItsWheels) {
  for (const double leap : {30.0, 60.0, 150.0}) {
    Rig rig(config_);
    std::mt19937 engine(5);
    const double most = run(rig, [&](base::ImuSample& imu, double) {
      if (std::uniform_real_distribution<double>()(engine) < 0.02) imu.acceleration.x() += leap;
    });
    EXPECT_LT(most, 1.0) << leap;
    EXPECT_FALSE(rig.odometry.back().flags & odometry_t::NO_WHEELS);
    const NodeReport report = rig.node.report();
    EXPECT_TRUE(std::any_of(report.faults.begin(), report.faults.end(), [](const std::string& fault) {
      return fault.find("leapt away from those before and after") != std::string::npos;
    }));
  }
}

TEST_F(BadImu, AnAccelerometerThatIsStuckIsDoneWithout) {
  for (const std::array<bool, 3>& stuck : {std::array{true, false, false}, std::array{true, true, false},
                                           std::array{false, false, true}, std::array{true, true, true}}) {
    for (const double from : {0.5, 8.0, 20.0, 31.0}) {
      Rig rig(config_);
      std::optional<Eigen::Vector3d> held;
      const double most = run(rig, [&](base::ImuSample& imu, double seconds) {
        if (seconds < from) return;
        if (!held) held = imu.acceleration;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const auto i = static_cast<Eigen::Index>(axis);
          if (stuck[axis]) imu.acceleration[i] = (*held)[i];
        }
      });
      EXPECT_LT(most, from < 1.0 ? 8.0 : 4.0) << from;  // without a gyro the wheels' slips turn it
      EXPECT_FALSE(rig.odometry.back().flags & odometry_t::NO_WHEELS);
      EXPECT_GT(rig.node.report().counters["refused.stuck.imu"], 1000);
    }
  }
}

bool says(const NodeReport& report, const std::string& words) {
  return std::any_of(report.faults.begin(), report.faults.end(),
                     [&](const std::string& fault) { return fault.find(words) != std::string::npos; });
}

/// The largest tilt of odometry against the truth, rad.
double largest_tilt(const std::vector<odometry_t>& odometry, const Drive& drive) {
  const std::size_t start = drive.index_of(odometry.front().utime);
  double most = 0.0;
  for (const odometry_t& message : odometry) {
    const Pose truth = drive.T_odom_base(std::min(drive.index_of(message.utime), drive.truth.size() - 1), start);
    const Pose pose = pose_from_arrays(message.position, message.orientation);
    const Eigen::Vector3d up = pose.linear().row(2), truly_up = truth.linear().row(2);
    most = std::max(most, up.cross(truly_up).norm());
  }
  return most;
}

constexpr const char* kVertical = "its vertical part is not used";

TEST_F(BadImu, AVerticalForceThatLeapsCostsOnlyItself) {
  for (const double leap : {-2.0, 0.7, 2.0, 5.0}) {
    for (const double from : {5.0, 15.0}) {
      Rig rig(config_);
      const double most = run(rig, [&](base::ImuSample& imu, double seconds) {
        if (seconds >= from) imu.acceleration.z() += leap;
      });
      EXPECT_LT(most, 1.0) << leap << " " << from;
      const Drive drive = simulate_town_drive({.seconds = 60.0}, config_.vehicle);
      EXPECT_LT(largest_tilt(rig.odometry, drive), 0.02) << leap << " " << from;
      const NodeReport report = rig.node.report();
      EXPECT_TRUE(says(report, kVertical)) << leap << " " << from;
      EXPECT_EQ(report.counters["reset.doubt"], 0) << leap << " " << from;
      EXPECT_FALSE(rig.odometry.back().flags & odometry_t::NOT_LEVEL);
    }
  }
}

TEST_F(BadImu, AVerticalForceThatOverflowsCostsOnlyItself) {
  Rig rig(config_);
  const double most = run(rig, [&](base::ImuSample& imu, double seconds) {
    if (seconds >= 15.0 && imu.acceleration.z() > 10.0) imu.acceleration.z() -= 20.0;
  });
  EXPECT_LT(most, 1.0);
  const Drive drive = simulate_town_drive({.seconds = 60.0}, config_.vehicle);
  EXPECT_LT(largest_tilt(rig.odometry, drive), 0.02);
  EXPECT_GE(rig.node.report().counters["faults.vertical_force"], 1);
}

TEST_F(BadImu, AVerticalForceThatComesBackIsUsedAgain) {
  Rig rig(config_);
  const double most = run(rig, [&](base::ImuSample& imu, double seconds) {
    if (seconds >= 15.0 && seconds < 25.0) imu.acceleration.z() += 3.0;
  });
  EXPECT_LT(most, 1.0);
  EXPECT_EQ(rig.node.report().counters["faults.vertical_force"], 1);
  EXPECT_FALSE(says(rig.node.report(), kVertical));
}

}  // namespace
}  // namespace curbstone::ekf
