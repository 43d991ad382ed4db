// What the driver and the emulated devices must agree on: where each shot of a firing went, and when.
#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "drivers/lidar/models/make_model.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/helios_emulator.hpp"
#include "tools/simulate/devices/make_lidar.hpp"
#include "tools/simulate/devices/vlp16_emulator.hpp"

namespace curbstone::lidar {
namespace {

using simulate::devices::LidarEmulator;
using simulate::devices::LidarRay;
using simulate::devices::LidarShot;

using test::kStart;

struct Point {
  Eigen::Vector3d position;
  double time = 0;  ///< s after the packet's first shot
};

/// A device's packets, and where each return really is.
class Drive {
 public:
  Drive(LidarEmulator& device, models::ModelName name)
      : device_(device), model_(models::make_model(name, {.limits = {0.1, 100}, .distance_step = {}, .angles = {}})) {
    for (int i = 0; i < 2; ++i)
      EXPECT_EQ(model_->read_info(kStart + i, device.info(kStart + i)), decoding::Refusal::kNone);
  }

  /// The next packet. `apart`: m from the strongest to the last return.
  void packet(float apart) {
    const auto& table = device_.table();
    std::vector<LidarRay> rays(static_cast<std::size_t>(table.lasers));
    std::vector<LidarShot> strongest(rays.size()), last(rays.size());
    truth_.clear();
    const std::int64_t begin = firing_;
    for (std::optional<LidarEmulator::Bytes> bytes; !bytes; ++firing_) {
      const double azimuth = static_cast<double>(firing_) * device_.azimuth_step();
      device_.beams(azimuth, rays);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const float range = 4.0F + 0.25F * static_cast<float>(i) + 0.5F * static_cast<float>(firing_ % 5);
        strongest[i] = {range, 10};
        last[i] = {range + apart, static_cast<std::uint8_t>(apart > 0 ? 20 : 10)};
        const double time = static_cast<double>(firing_ - begin) * table.firing_period + rays[i].time_offset;
        truth_.push_back({rays[i].origin + static_cast<double>(range) * rays[i].direction, time});
        if (apart > 0)
          truth_.push_back({rays[i].origin + static_cast<double>(range + apart) * rays[i].direction, time});
      }
      bytes = device_.add_firing(utime(firing_), azimuth, strongest, last);
      if (bytes) bytes_ = *bytes;
    }
    ASSERT_EQ(model_->decode(utime(begin) + 2000, bytes_, decoded_), decoding::Refusal::kNone);
    ASSERT_TRUE(decoded_.stamp);
    EXPECT_NEAR(static_cast<double>(*decoded_.stamp - utime(begin)), 0, 1.0);
  }

  void expect_truth() const {
    ASSERT_EQ(decoded_.x.size(), truth_.size());
    for (std::size_t i = 0; i < decoded_.x.size(); ++i) {
      const Eigen::Vector3d p(static_cast<double>(decoded_.x[i]), static_cast<double>(decoded_.y[i]),
                              static_cast<double>(decoded_.z[i]));
      const auto nearest =
          std::ranges::min_element(truth_, {}, [&](const Point& point) { return (point.position - p).squaredNorm(); });
      // Half a step of range, and 0.01 to 0.02 deg of the azimuths, at up to 18 m.
      ASSERT_LT((nearest->position - p).norm(), 0.007) << "point " << i;
      ASSERT_NEAR(static_cast<double>(decoded_.time_offset[i]), nearest->time, 1e-6) << "point " << i;
    }
  }

 private:
  [[nodiscard]] std::int64_t utime(std::int64_t firing) const {
    return kStart + std::llround(static_cast<double>(firing) * device_.table().firing_period * 1e6);
  }

  LidarEmulator& device_;
  std::unique_ptr<models::Model> model_;
  decoding::DecodedPacket decoded_;
  std::vector<Point> truth_;
  LidarEmulator::Bytes bytes_;
  std::int64_t firing_ = 0;
};

TEST(EmulatedModels, AreReadBackByTheDriver) {
  using simulate::devices::LidarName;
  const std::pair<LidarName, models::ModelName> names[] = {{LidarName::kRs16, models::ModelName::kRs16},
                                                           {LidarName::kVlp16, models::ModelName::kVlp16},
                                                           {LidarName::kHelios16p, models::ModelName::kHelios16p},
                                                           {LidarName::kHelios32, models::ModelName::kHelios32}};
  for (const auto& [device_name, model_name] : names) {
    for (const double rpm : {300.0, 600.0, 1200.0}) {
      const auto device = simulate::devices::make_lidar(device_name, rpm);
      SCOPED_TRACE(std::string(device->table().name) + " at " + std::to_string(rpm));
      Drive drive(*device, model_name);
      for (int i = 0; i < 60; ++i) {
        drive.packet(0);
        drive.expect_truth();
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(EmulatedModels, AreReadBackWithBothReturns) {
  using simulate::devices::HeliosEmulator;
  using simulate::devices::ReturnMode;
  simulate::devices::Vlp16Emulator vlp16({.rpm = 600, .mode = ReturnMode::kDual});
  HeliosEmulator helios16({.lasers = 16, .rpm = 600, .mode = ReturnMode::kDual, .angles = {}});
  HeliosEmulator helios32({.lasers = 32, .rpm = 600, .mode = ReturnMode::kDual, .angles = {}});
  simulate::devices::Rs16Emulator rs16({.rpm = 600, .mode = ReturnMode::kDual});
  const std::pair<LidarEmulator*, models::ModelName> devices[] = {{&rs16, models::ModelName::kRs16},
                                                                  {&vlp16, models::ModelName::kVlp16},
                                                                  {&helios16, models::ModelName::kHelios16p},
                                                                  {&helios32, models::ModelName::kHelios32}};
  for (const auto& [device, name] : devices) {
    SCOPED_TRACE(std::string(device->table().name));
    Drive drive(*device, name);
    for (int i = 0; i < 60; ++i) {
      drive.packet(1.5F);
      drive.expect_truth();
      if (HasFatalFailure()) return;
    }
  }
}

TEST(EmulatedModels, GiveAReturnThatIsBothTheStrongestAndTheLastOnce) {
  simulate::devices::Vlp16Emulator vlp16({.rpm = 600, .mode = simulate::devices::ReturnMode::kDual});
  Drive drive(vlp16, models::ModelName::kVlp16);
  drive.packet(0);
  drive.expect_truth();
  simulate::devices::Rs16Emulator rs16({.rpm = 600, .mode = simulate::devices::ReturnMode::kDual});
  Drive rs16_drive(rs16, models::ModelName::kRs16);
  rs16_drive.packet(0);
  rs16_drive.expect_truth();
}

}  // namespace
}  // namespace curbstone::lidar
