#pragma once

#include <gtest/gtest.h>

#include <curbstone/odometry_t.hpp>
#include <curbstone/pose_t.hpp>
#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "services/ekf/ekf_node.hpp"
#include "tests/services/ekf/sample_messages.hpp"
#include "tests/services/ekf/simulated_drive.hpp"

namespace curbstone::ekf {

inline DriveOptions short_drive() {
  DriveOptions o;
  o.seconds = 20.0;
  o.gyro_bias << 0.004, -0.006, 0.008;
  o.accelerometer_bias << 0.03, -0.02, 0.04;
  return o;
}

/// A node, a drive for it, and what it says of it.
class EkfNodeTest : public ::testing::Test {
 protected:
  EkfNodeTest() : drive_(simulate_drive(short_drive(), config_.vehicle)) {}

  /// A node on a bus of its own, whose every published byte is kept.
  struct Rig {
    explicit Rig(const base::EkfConfig& config) : node(config, bus) {
      bus.tap([this](const std::string& channel, const void* data, int size, std::int64_t) {
        if (channel == "ODOMETRY" || channel == "POSE")
          bytes.append(static_cast<const char*>(data), static_cast<std::size_t>(size));
      });
      node.connect(bus);
      bus.subscribe<odometry_t>("ODOMETRY", [this](const odometry_t& m) { odometry.push_back(m); });
      bus.subscribe<pose_t>("POSE", [this](const pose_t& m) { poses.push_back(m); });
    }
    template <class Message>
    void send(const std::string& channel, const Message& message) {
      bus.publish(channel, message);
      bus.dispatch();
    }
    void finish() {
      node.finish();
      bus.dispatch();
    }
    LocalBus bus;
    EkfNode node;
    std::vector<odometry_t> odometry;
    std::vector<pose_t> poses;
    std::string bytes;
  };

  void send(Rig& rig, std::size_t i) {
    rig.send("WHEELS", message_of(drive_.wheels[i], static_cast<std::int32_t>(i)));
    rig.send("IMU", message_of(drive_.imu[i], static_cast<std::int32_t>(i)));
  }

  base::EkfConfig config_;
  Drive drive_;
};

}  // namespace curbstone::ekf
