#pragma once

#include <gmock/gmock.h>

#include <cstdint>
#include <curbstone/map_pose_t.hpp>
#include <optional>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "services/localizer/localizer_node.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "tests/services/localizer/yard.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::localizer::test_yard {

inline constexpr std::int64_t kStart = 1'750'000'000'000'000;  // us
inline constexpr std::int64_t kRevolution = 50'000;            // us

/// A localizer with the map of a yard, in which the vehicle stands at the origin, or drives straight on from it.
class LocalizerOnAYard : public ::testing::Test {
 protected:
  LocalizerOnAYard() {
    config_.map = map_file("map.db", map_of(yard_));
    config_.vehicle.lidar = {0, 0, 0, 0, 0, 0};
    config_.start = {0, 0, 0};
    bus_.subscribe<map_pose_t>("LOCALIZED_POSE", [this](const map_pose_t& pose) { poses_.push_back(pose); });
  }
  std::string map_file(const std::string& name, const std::vector<semantic_map::tile::MapTile>& tiles) {
    const std::string file = (folder_ / name).string();
    semantic_map::store::MapStore store(file);
    store.write({.epoch = 7, .tiles = tiles});
    store.close_canonical();
    return file;
  }
  /// That can be found with nothing known.
  void in_an_open_yard() {
    yard_.open = true;
    config_.map = map_file("open.db", map_of(yard_));
    config_.start.clear();
  }
  void begin() {
    node_.emplace(config_, bus_);
    node_->connect(bus_);
  }
  /// Another process, another drive.
  void begin_anew() {
    clock_ = kStart;
    heard_ = kStart - 50'000;
    seen_ = 0;
    poses_.clear();
    begin();
  }
  /// All stamps leap by `step`; odometry's filter drops the samples of the first `dropped`.
  void set_clock(std::int64_t step, std::int64_t dropped = 0) {
    clock_ += step;
    heard_ = clock_ + seen_ * kRevolution + 10'000 + dropped;
  }
  void expect_no_lost_pose(std::int64_t step) const {
    for (const map_pose_t& pose : poses_)
      EXPECT_FALSE(pose.revolution > 20 && (pose.flags & map_pose_t::LOST) != 0) << step << ' ' << pose.revolution;
    EXPECT_GE(poses_.size(), 97U);
  }
  /// T_map_base, so many revolutions after the beginning.
  [[nodiscard]] Pose at(double revolutions) const {
    return begin_ * pose_at(step_ * revolutions, 0, bend_ * step_ * revolutions);
  }
  /// A revolution in one message; all points are taken near its end.
  [[nodiscard]] lidar_points_t packet(int revolution) const {
    lidar_points_t message{};
    message.utime = clock_ + revolution * kRevolution + lidar_off_;
    message.packet = message.revolution = revolution;
    for (const Eigen::Vector3d& p : points_in(yard_, at(revolution + 0.98))) {
      message.x.push_back(static_cast<float>(p.x()));
      message.y.push_back(static_cast<float>(p.y()));
      message.z.push_back(static_cast<float>(p.z()));
    }
    message.num_points = static_cast<std::int32_t>(message.x.size());
    message.time_offset.assign(message.x.size(), 0.049F);
    message.intensity.assign(message.x.size(), 10);
    message.ring.assign(message.x.size(), 0);
    return message;
  }
  [[nodiscard]] odometry_t odometry(std::int64_t utime) const {
    odometry_t message{};
    message.utime = utime;
    pose_to_arrays(at(static_cast<double>(utime - clock_) / kRevolution), message.position, message.orientation);
    message.flags = odometry_t::INITIALISED;
    return message;
  }
  void odometry_until(int revolution) {
    for (; heard_ <= clock_ + revolution * kRevolution; heard_ += 10'000) node_->on(odometry(heard_));
    bus_.dispatch();
  }
  void lidar_until(int revolution) {
    for (; seen_ < revolution; ++seen_) node_->on(packet(seen_));
    bus_.dispatch();
  }
  /// Both, in step.
  void drive_until(int revolution) {
    while (seen_ < revolution) {
      odometry_until(seen_ + 1);
      lidar_until(seen_ + 1);
    }
  }
  [[nodiscard]] bool lost() const { return (poses_.back().flags & map_pose_t::LOST) != 0; }
  /// m, of the last pose.
  [[nodiscard]] double error() const {
    const Pose truth = at(static_cast<double>(poses_.back().utime - clock_) / kRevolution);
    const double* p = poses_.back().map_base_position;
    return (truth.translation().head<2>() - Eigen::Vector2d(p[0], p[1])).norm();
  }

  const curbstone::test::TemporaryFolder folder_;
  Yard yard_;
  LocalizerConfig config_;
  LocalBus bus_;
  std::optional<LocalizerNode> node_;
  std::vector<map_pose_t> poses_;
  Pose begin_ = Pose::Identity();
  double step_ = 0;  // m a revolution
  double bend_ = 0;  // rad/m
  std::int64_t clock_ = kStart;
  std::int64_t lidar_off_ = 0;  // us: the LiDAR's clock alone is wrong by that
  std::int64_t heard_ = kStart - 50'000;
  int seen_ = 0;
};

}  // namespace curbstone::localizer::test_yard
