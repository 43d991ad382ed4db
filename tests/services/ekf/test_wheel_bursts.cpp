// WHEELS that a busy bus or host holds up: they come late and all at once, out of order, twice.
#include <algorithm>
#include <random>

#include "tests/services/ekf/ekf_node_test.hpp"

namespace curbstone::ekf {
namespace {

class WheelBursts : public EkfNodeTest {
 protected:
  static constexpr std::size_t kBurst = 50;  // samples: 0.5 s
  static constexpr std::size_t kFirst = 600, kLast = 1400;

  /// Between kFirst and kLast WHEELS come in bursts, which `spoil` may change.
  void run(Rig& rig, const std::function<void(std::vector<wheels_t>&)>& spoil) {
    std::vector<wheels_t> waiting;
    for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
      const wheels_t wheels = message_of(drive_.wheels[i], static_cast<std::int32_t>(i));
      if (spoil && i >= kFirst && i < kLast) {
        waiting.push_back(wheels);
        if (waiting.size() == kBurst) {
          spoil(waiting);
          for (const wheels_t& m : waiting) rig.send("WHEELS", m);
          waiting.clear();
        }
      } else {
        rig.send("WHEELS", wheels);
      }
      rig.send("IMU", message_of(drive_.imu[i], static_cast<std::int32_t>(i)));
    }
    rig.finish();
  }

  void expect_same_pose(const Rig& undisturbed, const Rig& rig) {
    const model::Belief& a = undisturbed.node.filter().filter().belief();
    const model::Belief& b = rig.node.filter().filter().belief();
    EXPECT_EQ(a.utime, b.utime);
    EXPECT_EQ(model::minus(a.mean, b.mean).norm(), 0.0);
    EXPECT_EQ(a.covariance, b.covariance);
    ASSERT_EQ(undisturbed.odometry.size(), rig.odometry.size());
    const odometry_t& x = undisturbed.odometry.back();
    const odometry_t& y = rig.odometry.back();
    const Pose apart =
        pose_from_arrays(x.position, x.orientation).inverse() * pose_from_arrays(y.position, y.orientation);
    std::printf("[ figure ] after %zu bursts: %.4f m, %.4f deg from the undisturbed pose\n", (kLast - kFirst) / kBurst,
                apart.translation().norm(), Eigen::AngleAxisd(apart.linear()).angle() * 180 / M_PI);
    EXPECT_LT(apart.translation().norm(), 0.03);
    EXPECT_LT(Eigen::AngleAxisd(apart.linear()).angle(), 1e-3);
    const NodeReport report = rig.node.report();
    for (const auto& [name, value] : report.counters.values())
      EXPECT_FALSE(name.starts_with("withheld.") || name.starts_with("slips.") || name.starts_with("dropped.late"))
          << name;
    EXPECT_TRUE(report.faults.empty());
  }
};

TEST_F(WheelBursts, LateAndAllAtOnceTheyLeadToTheSamePose) {
  Rig undisturbed(config_), rig(config_);
  run(undisturbed, nullptr);
  run(rig, [](auto&) {});
  EXPECT_GT(rig.node.report().counters["rewound.wheels"], 400);  // 0.2 s of each burst are not late
  expect_same_pose(undisturbed, rig);
}

TEST_F(WheelBursts, OutOfOrderTooTheyDo) {
  Rig undisturbed(config_), rig(config_);
  run(undisturbed, nullptr);
  std::mt19937 random(5);
  run(rig, [&](auto& burst) { std::shuffle(burst.begin(), burst.end(), random); });
  EXPECT_GT(rig.node.report().counters["disordered.wheels"], 500);
  expect_same_pose(undisturbed, rig);
}

TEST_F(WheelBursts, AndDoubledInAnyOrder) {
  Rig undisturbed(config_), rig(config_);
  run(undisturbed, nullptr);
  std::mt19937 random(7);
  run(rig, [&](auto& burst) {
    burst.insert(burst.end(), burst.begin(), burst.begin() + kBurst);
    std::shuffle(burst.begin(), burst.end(), random);
  });
  EXPECT_EQ(rig.node.report().counters["dropped.duplicate.wheels"], kLast - kFirst);
  expect_same_pose(undisturbed, rig);
}

}  // namespace
}  // namespace curbstone::ekf
