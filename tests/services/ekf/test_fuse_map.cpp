// ekf with `fuse_map` and mapper on one bus: what the mapper makes of odometry comes back to the filter.

#include <gtest/gtest.h>

#include <algorithm>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "services/ekf/ekf_node.hpp"
#include "services/mapper/mapper_node.hpp"
#include "tests/services/ekf/sample_messages.hpp"
#include "tests/services/ekf/simulated_drive.hpp"
#include "tests/services/mapper/synthetic_world.hpp"

namespace curbstone::ekf {
namespace {

constexpr double kRevolution = 0.05;  // s, of a revolution
constexpr double kDriven = 17;
constexpr double kScale = 0.02;  // by which the wheels are larger than the filter believes

test::SyntheticWorld distinct_street() {
  test::SyntheticWorld world = test::street();
  world.noise = 0.01;
  world.boxes.push_back({{-16, 3, 0}, {-13, 6, 3}});
  world.boxes.push_back({{2, -8, 0}, {4, -6, 2.2}});
  world.boxes.push_back({{-28, 4, 0}, {-26, 5, 2.5}});
  return world;
}

/// 2 s of standing, then 40 m down the street with its wheels larger than configured.
const Drive& street_drive() {
  static const Drive drive = [] {
    DriveOptions o;
    o.seconds = kDriven;
    o.stop_at = 1e9;
    o.hills = 0;
    o.curves = 0.03;
    o.gyro_bias << 0.004, -0.006, 0.008;
    o.wheel_scale << kScale, kScale, 0;
    return simulate_drive(o, base::EkfConfig{}.vehicle);
  }();
  return drive;
}

double seconds_of(std::int64_t utime) {
  return static_cast<double>(utime - test::SyntheticWorld::kEpoch) * 1e-6;
}

Pose T_street_base(double t) {
  const std::vector<TruePose>& truth = street_drive().truth;
  const double place =
      std::clamp((t - seconds_of(truth.front().utime)) / 0.01, 0.0, static_cast<double>(truth.size() - 2));
  const auto i = static_cast<std::size_t>(place);
  return test::pose(-25, -1, 0, 0, 0, 0) *
         interpolate(truth[i].T_world_base, truth[i + 1].T_world_base, place - static_cast<double>(i));
}

/// Where the LiDAR is, and what is about it: not always where wheels and IMU drive.
struct Scene {
  test::SyntheticWorld world = distinct_street();
  test::SyntheticWorld::Trajectory trajectory = T_street_base;
  bool mapper_dies = false;  ///< and is started again at once
};

/// Hears what it is given, and speaks to all: it may be killed, and another take its place.
struct MapperProcess {
  LocalBus ears;
  mapper::MapperNode node;
  explicit MapperProcess(LocalBus& bus) : node({}, bus) { node.connect(ears); }
  template <class Message>
  void hear(const std::string& channel, const Message& message) {
    ears.publish(channel, message);
    ears.dispatch();
  }
};

struct Vehicle {
  LocalBus bus;
  EkfNode ekf;
  std::optional<MapperProcess> mapper;
  std::vector<odometry_t> odometry;
  std::vector<map_pose_t> map;

  explicit Vehicle(bool fuse) : ekf(config(fuse), bus) {
    mapper.emplace(bus);
    ekf.connect(bus);
    bus.subscribe<odometry_t>("ODOMETRY", [this](const odometry_t& m) {
      odometry.push_back(m);
      mapper->hear("ODOMETRY", m);
    });
    bus.subscribe<map_pose_t>("MAP_POSE", [this](const map_pose_t& m) { map.push_back(m); });
  }
  static base::EkfConfig config(bool fuse) {
    base::EkfConfig config;
    config.fuse_map = fuse;
    return config;
  }
  /// The drive, all messages in the order of their stamps. `scene_at`: of a revolution that begins then; without one,
  /// there is no LiDAR.
  void drive(const std::function<Scene(double)>& scene_at = {}) {
    const Drive& samples = street_drive();
    std::size_t sent = 0;
    const auto send_until = [&](std::int64_t utime) {
      for (; sent < samples.imu.size() && samples.imu[sent].utime <= utime; ++sent) {
        bus.publish("IMU", message_of(samples.imu[sent], static_cast<std::int32_t>(sent)));
        bus.publish("WHEELS", message_of(samples.wheels[sent], static_cast<std::int32_t>(sent)));
        bus.dispatch();
      }
    };
    for (int n = 0; scene_at && (n + 1) * kRevolution < kDriven - 0.1; ++n) {
      const Scene scene = scene_at(n * kRevolution);
      if (scene.mapper_dies) mapper.emplace(bus);
      const Pose T_base_lidar = test::default_lidar();
      for (const auto& packet : scene.world.packets(scene.trajectory, T_base_lidar, n, n * kRevolution, kRevolution)) {
        send_until(packet.utime);
        mapper->hear("LIDAR_POINTS", packet);
        bus.dispatch();
      }
    }
    send_until(samples.imu.back().utime);
    ekf.finish();
    bus.dispatch();
  }
  [[nodiscard]] std::int64_t count(const char* name) const { return ekf.report().counters[name]; }
  [[nodiscard]] std::int64_t mapper_count(const char* name) const { return mapper->node.report().counters[name]; }
  /// Longest step of odom, less the way that the true speed explains; m.
  [[nodiscard]] double worst_jump() const {
    double worst = 0;
    for (std::size_t i = 1; i < odometry.size(); ++i) {
      const double step = (Eigen::Vector3d(odometry[i].position) - Eigen::Vector3d(odometry[i - 1].position)).norm();
      const double dt = seconds_of(odometry[i].utime) - seconds_of(odometry[i - 1].utime);
      worst = std::max(worst, step - dt * std::abs(odometry[i].velocity[0]));
    }
    return worst;
  }
  /// How long odometry believes a metre to be since a time, less one.
  [[nodiscard]] double scale_error(double since) const {
    const auto first = std::find_if(odometry.begin(), odometry.end(),
                                    [&](const odometry_t& m) { return seconds_of(m.utime) >= since; });
    const Eigen::Vector3d way = Eigen::Vector3d(odometry.back().position) - Eigen::Vector3d(first->position);
    const Eigen::Vector3d truth = T_street_base(seconds_of(odometry.back().utime)).translation() -
                                  T_street_base(seconds_of(first->utime)).translation();
    return way.norm() / truth.norm() - 1;
  }
  [[nodiscard]] std::int64_t poses_with(std::int32_t flag) const {
    return std::count_if(map.begin(), map.end(), [&](const map_pose_t& m) { return (m.flags & flag) != 0; });
  }
};

constexpr double kContinuous = 2e-3;  // m, of a step of 10 ms

TEST(FuseMap, TheMapperTeachesTheWheelsTheirSizeAndOdomGoesOnWithoutJumps) {
  Vehicle alone(false);
  alone.drive();
  Vehicle fused(true);
  fused.drive([](double) { return Scene{}; });
  EXPECT_LT(std::abs(fused.scale_error(8)), 1e-3);
  EXPECT_LT(std::abs(fused.scale_error(8)), 0.3 * std::abs(alone.scale_error(8))) << "by the accelerometer alone";
  EXPECT_LT(fused.worst_jump(), kContinuous);
  EXPECT_GT(fused.count("map.used"), 15);
  EXPECT_EQ(fused.count("refused.lost.map"), 0);
  EXPECT_EQ(fused.mapper_count("lost.refused"), 0);
}

/// Put down 9 m behind, where it has been, while the wheels turn on: found there again in the same epoch.
TEST(FuseMap, AVehicleThatIsCarriedAwayJumpsInTheMapButNotInOdom) {
  Vehicle fused(true);
  fused.drive([](double t) {
    Scene scene;
    if (t > 9) scene.trajectory = [](double at) { return T_street_base(at - 3); };
    return scene;
  });
  EXPECT_GT(fused.poses_with(map_pose_t::LOST), 5);
  EXPECT_GT(fused.mapper_count("found"), 0);
  EXPECT_EQ(fused.map.back().flags & map_pose_t::LOST, 0) << "found again";
  EXPECT_LT(fused.worst_jump(), kContinuous);
  EXPECT_LT(std::abs(fused.scale_error(10)), 2e-3);
  EXPECT_EQ(fused.count("refused.lost.map"), fused.poses_with(map_pose_t::LOST));
  EXPECT_GT(fused.count("map.used"), 10);
}

/// For 2 s the scans are those of a vehicle that stands, and the mapper follows them. Then it dies; the next one begins
/// another map, in a new epoch.
TEST(FuseMap, PosesThatAreWrongAndAMapThatBeginsAnewDoTheFilterNoHarm) {
  constexpr double kStuck = 10, kFree = 12;  // s
  Vehicle fused(true);
  fused.drive([](double t) {
    Scene scene;
    if (t > kStuck && t < kFree) scene.trajectory = [](double) { return T_street_base(kStuck); };
    scene.mapper_dies = std::abs(t - kFree) < kRevolution / 2;
    return scene;
  });
  EXPECT_GT(fused.count("gated.map"), 2) << "what wheels and IMU contradict weighs little";
  EXPECT_EQ(fused.count("map.epochs"), 2) << "the map of the first standstill gave way to the drive's, and it died";
  EXPECT_NE(fused.map.front().epoch, fused.map.back().epoch);
  EXPECT_LT(fused.worst_jump(), kContinuous);
  EXPECT_LT(std::abs(fused.scale_error(kStuck)), 2e-3);
  EXPECT_LT(std::abs(fused.scale_error(kFree)), 2e-3);
}

}  // namespace
}  // namespace curbstone::ekf
