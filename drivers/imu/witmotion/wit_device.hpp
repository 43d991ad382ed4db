#pragma once

#include "drivers/imu/device/imu_device.hpp"
#include "drivers/imu/device/sample_time.hpp"
#include "drivers/imu/witmotion/wit_configurator.hpp"
#include "drivers/imu/witmotion/wit_frame.hpp"
#include "drivers/link/link_state.hpp"

namespace curbstone::imu::witmotion {

/// A WitMotion IMU (WT901, HWT905, JY901, JY61P) with the default ranges, 16 g and 2000 deg/s. A sample is a group of
/// frames with ascending ids and without a common number: a group begins with an id that is not above the one before. A
/// group that lacks a frame which earlier groups had is not used. Its time is that of frame 50, in ms, if it has one.
///
/// Counts, in addition to those of WitParser and WitConfigurator: skipped.frames (other ids), skipped.incomplete
/// (groups without acceleration or rate of turn), refused.group (a frame is missing), refused.range (an invalid time of
/// day, or no unit quaternion), refused.time, refused.repeated (SampleTime), lost.packets (samples, by their time).
class WitDevice final : public device::ImuDevice {
 public:
  WitDevice(const device::DeviceSettings& settings, Send send);

  void on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes, const Handler& handler) override;
  void on_link(std::int64_t now, link::LinkState state) override;
  void tick(std::int64_t now) override { configurator_.tick(now); }
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] std::string fault() const override { return rate_fault_.empty() ? configurator_.fault() : rate_fault_; }

 private:
  struct Group {
    unsigned ids = 0;  // bit k: frame 0x50 + k was received
    std::uint8_t last = 0;
    bool broken = false;     // data was lost within it
    bool done = false;       // used or counted
    std::int64_t begun = 0;  // us, receipt of the first frame
    std::int64_t ended = 0;  // us, receipt of the last frame
    int frames = 0;
    std::optional<std::uint32_t> ticks;  // of 0.1 ms since midnight
    device::ImuSample sample;
  };

  void on_frame(std::int64_t now, const WitFrame& frame, const Handler& handler);
  void take(const WitFrame& frame);
  void end_group(std::int64_t now, const Handler& handler);
  void use_group(const Handler& handler);
  bool judge_time();
  void watch_rate(std::int64_t now);

  device::DeviceSettings settings_;
  WitParser parser_;
  WitConfigurator configurator_;
  device::SampleTime sample_time_;
  Group group_;
  unsigned expected_ = 0;  // ids of a whole group
  unsigned fewer_ = 0;     // ids of the latest groups, if they were fewer
  int fewer_times_ = 0;
  std::int64_t wrong_rate_since_ = 0;  // us; 0: the rate is right
  std::string rate_fault_;
  Counters counters_;
};

}  // namespace curbstone::imu::witmotion
