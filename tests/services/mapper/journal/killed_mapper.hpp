#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/config/config.hpp"
#include "common/resend/message_keeper.hpp"
#include "services/mapper/journal/journal_file.hpp"
#include "services/mapper/mapper_node.hpp"
#include "tests/services/mapper/mapper_drive.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::mapper::journal {

inline test::SyntheticWorld known_street() {
  test::SyntheticWorld world = test::street();
  world.noise = 0.01;
  world.boxes.push_back({{-16, 3, 0}, {-13, 6, 3}});
  world.boxes.push_back({{2, -8, 0}, {4, -6, 2.2}});
  return world;
}

/// The sensors of one drive, whoever maps it. What a mapper said of itself outlives it.
class KilledMapperTest : public ::testing::Test {
 protected:
  KilledMapperTest() {
    config_.journal = folder_ / "drive.journal";
    bus_.subscribe<map_pose_t>("MAP_POSE", [this](const map_pose_t& m) { poses_.push_back(m); });
    bus_.subscribe<map_trajectory_t>("MAP_TRAJECTORY", [this](const map_trajectory_t& m) { pages_.push_back(m); });
    sensor_bus_.subscribe<lidar_points_t>(resent_channel("LIDAR_POINTS"), [this](const lidar_points_t& m) {
      if (mapper_bus_) mapper_bus_->publish(resent_channel("LIDAR_POINTS"), m);
    });
    sensor_bus_.subscribe<odometry_t>(resent_channel("ODOMETRY"), [this](const odometry_t& m) {
      if (mapper_bus_) mapper_bus_->publish(resent_channel("ODOMETRY"), m);
    });
    start_driver();
    start_filter();
  }
  /// What was sent before is forgotten.
  void start_driver() { driver_ = std::make_unique<MessageKeeper>(sensor_bus_, "LIDAR_POINTS"); }
  void start_filter() { filter_ = std::make_unique<MessageKeeper>(sensor_bus_, "ODOMETRY"); }

  void start_mapper() {
    mapper_bus_ = std::make_unique<LocalBus>();
    mapper_bus_->subscribe<map_pose_t>("MAP_POSE", [this](const map_pose_t& m) { bus_.publish("MAP_POSE", m); });
    mapper_bus_->subscribe<map_trajectory_t>("MAP_TRAJECTORY",
                                             [this](const map_trajectory_t& m) { bus_.publish("MAP_TRAJECTORY", m); });
    node_ = std::make_unique<MapperNode>(config_, *mapper_bus_);
    is_new_ = true;
    node_->connect(*mapper_bus_);
    mapper_bus_->subscribe<resend_request_t>(kResendRequests, [this](const resend_request_t& m) {
      driver_->request(m);
      filter_->request(m);
    });
  }
  /// No farewell: what has not come to the disk by then never will. It does within a revolution, unless the machine is
  /// busy.
  void kill_mapper() {
    if (!config_.journal.empty()) await_journal();
    kill_mapper_at_once();
  }
  void kill_mapper_at_once() {
    node_.reset();
    mapper_bus_.reset();
  }
  void await_journal() {
    ConfigOf<config::MapperConfig> config;
    config.value = config_;
    const std::string hash = config_hash("mapper", config);
    const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    const auto is_there = [&] {
      if (!age_of_journal(config_.journal)) return false;
      const auto recorded = read_journal(config_.journal, 1'000'000'000, hash);
      return recorded && recorded->poses.back().utime == poses_.back().utime;
    };
    while (!is_there()) {
      if (std::chrono::steady_clock::now() > limit) throw std::runtime_error("the journal never has it");
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      node_->tick(test::utime(turn_ * test::kPeriod));
    }
  }
  void drive(int turns) {
    for (int i = 0; i < turns; ++i) step();
  }
  /// Until the driver and the filter have sent again what was asked for.
  void catch_up() { send_again(60); }
  /// For so many ticks.
  void send_again(int ticks) {
    for (int i = 0; node_ && i < ticks; ++i) {
      driver_->tick();
      filter_->tick();
      sensor_bus_.dispatch();
      mapper_bus_->dispatch();
      node_->tick(test::utime(turn_ * test::kPeriod));
      mapper_bus_->dispatch();
    }
    bus_.dispatch();
  }
  /// The vehicle does not wait for a mapper.
  void step() {
    const int n = turn_++;
    for (; odometry_sent_ < (n + 1) * test::kPeriod + 0.02; odometry_sent_ += 0.01) {
      odometry_t m{};
      m.utime = test::utime(odometry_sent_);
      m.flags = odometry_t::INITIALISED;
      pose_to_arrays(T_odom_start_ * trajectory_(0).inverse() * trajectory_(odometry_sent_), m.position, m.orientation);
      filter_->keep(m);
      if (mapper_bus_) mapper_bus_->publish("ODOMETRY", m);
    }
    const auto packets =
        world_.packets(trajectory_, config::MapperConfig{}.vehicle.T_base_lidar(), n, n * test::kPeriod, test::kPeriod);
    for (const lidar_points_t& packet : packets) driver_->keep(packet);
    if (!node_) return;
    for (const lidar_points_t& packet : packets) mapper_bus_->publish("LIDAR_POINTS", packet);
    mapper_bus_->dispatch();
    for (int i = 0; i < 2; ++i) node_->tick(test::utime(n * test::kPeriod + 0.02 * i));
    mapper_bus_->dispatch();
    bus_.dispatch();
    if (std::exchange(is_new_, false)) catch_up();
  }
  /// How far the newest pose is from where the vehicle is, in the frame of the drive's first map; m.
  [[nodiscard]] double error() const {
    const map_pose_t& m = poses_.back();
    const double t = static_cast<double>(m.utime - test::SyntheticWorld::kEpoch) * 1e-6;
    const Pose T_start_base = trajectory_(test::kPeriod).inverse() * trajectory_(t);
    return (pose_from_arrays(m.map_base_position, m.map_base_orientation).translation() - T_start_base.translation())
        .norm();
  }
  [[nodiscard]] std::int64_t counter(const std::string& name) const { return node_->report().counters[name]; }

  test::TemporaryFolder folder_;
  config::MapperConfig config_;
  test::SyntheticWorld world_ = known_street();
  test::SyntheticWorld::Trajectory trajectory_ = test::driving;
  LocalBus bus_;
  std::unique_ptr<LocalBus> mapper_bus_;
  LocalBus sensor_bus_;
  std::unique_ptr<MessageKeeper> driver_, filter_;
  std::unique_ptr<MapperNode> node_;
  bool is_new_ = false;
  std::vector<map_pose_t> poses_;
  std::vector<map_trajectory_t> pages_;
  Pose T_odom_start_ = Pose::Identity();
  double odometry_sent_ = -0.1;
  int turn_ = 0;
};

}  // namespace curbstone::mapper::journal
