// WHEELS whose counts are renewed more rarely than they are sent: a gateway that answers from its memory, a log of an
// older driver.
#include <cstdio>

#include "tests/services/ekf/ekf_node_test.hpp"
#include "tests/services/ekf/town_drive.hpp"

namespace curbstone::ekf {
namespace {

class RareCounts : public EkfNodeTest {
 protected:
  Drive town(double speed) const {
    TownDriveOptions options;
    options.speed = speed;
    options.seconds = 60;
    return simulate_town_drive(options, config_.vehicle);
  }
  /// m, from the truth at the end of the drive. Both counts come renewed each `every` samples, the right one `behind`
  /// samples after the left one.
  double error_at_end(const Drive& drive, std::size_t every, std::size_t behind) {
    Rig rig(config_);
    base::WheelSample shown = drive.wheels.front();
    for (std::size_t i = 0; i < drive.imu.size(); ++i) {
      if (i % every == 0) shown.angle[0] = drive.wheels[i].angle[0];
      if (i % every == behind) shown.angle[1] = drive.wheels[i].angle[1];
      shown.utime = drive.wheels[i].utime;
      rig.send("WHEELS", message_of(shown, static_cast<std::int32_t>(i)));
      rig.send("IMU", message_of(drive.imu[i], static_cast<std::int32_t>(i)));
    }
    rig.finish();
    faults_ = rig.node.report().faults;
    old_ = rig.node.report().counters["refused.old_counts"];
    if (rig.odometry.empty()) return 1e9;
    const odometry_t& last = rig.odometry.back();
    const Pose truth = drive.T_odom_base(drive.index_of(last.utime), drive.index_of(rig.odometry.front().utime));
    const double error = (pose_from_arrays(last.position, last.orientation).translation() - truth.translation()).norm();
    std::printf("[ figure ] renewed each %zu samples, %zu apart: %.2f m off after %.0f m, %lld old\n", every, behind,
                error, drive.distance, static_cast<long long>(old_));
    return error;
  }
  std::vector<std::string> faults_;
  std::int64_t old_ = 0;
};

TEST_F(RareCounts, CostLittle) {
  for (const double speed : {1.0, 3.0}) {
    const Drive drive = town(speed);
    for (const std::size_t every : {std::size_t{2}, std::size_t{5}, std::size_t{10}, std::size_t{20}}) {
      for (const std::size_t behind : {std::size_t{0}, every / 2}) {
        EXPECT_LT(error_at_end(drive, every, behind), 2.0);
        EXPECT_TRUE(faults_.empty()) << faults_.front();
        EXPECT_GT(old_, 1000);
      }
    }
  }
}

TEST_F(RareCounts, AreNoneInAHealthyDrive) {
  for (const double speed : {1.0, 3.0}) {
    EXPECT_LT(error_at_end(town(speed), 1, 0), 2.0);
    EXPECT_EQ(old_, 0) << speed;
  }
}

}  // namespace
}  // namespace curbstone::ekf
