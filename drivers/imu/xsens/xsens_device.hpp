#pragma once

#include "drivers/imu/device/imu_device.hpp"
#include "drivers/imu/device/sample_time.hpp"
#include "drivers/imu/xsens/increment_interval.hpp"
#include "drivers/imu/xsens/mt_configurator.hpp"
#include "drivers/imu/xsens/mtdata2.hpp"
#include "drivers/imu/xsens/packet_counter.hpp"
#include "drivers/imu/xsens/xbus_frame.hpp"
#include "drivers/link/link_state.hpp"

namespace curbstone::imu::xsens {

/// An Xsens MTi: Xbus frames with MTData2 messages. Its time is SampleTimeFine. Messages without inertial data (such as
/// those of its GNSS receiver, with the time of the fix) affect neither clock nor sequence. Velocity and rotation
/// increments are used instead of acceleration and rate of turn if each sample has them. A message whose items do not
/// end at its end is refused: a frame that lost bytes and took others from the next frame has a valid checksum once in
/// 256 times.
///
/// Counts, in addition to those of XbusParser, decode_mtdata2() and MtConfigurator: skipped.incomplete (messages
/// without inertial data), skipped.no_interval (increments before the sample interval is known), refused.time,
/// refused.repeated, refused.late (SampleTime, or the packet counter of a device that sends no time), lost.packets.
class XsensDevice final : public device::ImuDevice {
 public:
  XsensDevice(const device::DeviceSettings& settings, Send send);

  void on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes, const Handler& handler) override;
  void on_link(std::int64_t now, link::LinkState state) override;
  void tick(std::int64_t now) override { configurator_.tick(now); }
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] std::string fault() const override { return configurator_.fault(); }

 private:
  void on_frame(std::int64_t now, const XbusFrame& frame, const Handler& handler);
  bool judge(const MtData2& data, device::ImuSample& sample);
  bool judge_counter(std::uint16_t counter, const PacketCounter::Gap& gap);
  bool measure(const MtData2& data, device::ImuSample& sample) const;
  void restart_clock();

  device::DeviceSettings settings_;
  XbusParser parser_;
  MtConfigurator configurator_;
  device::SampleTime sample_time_;
  PacketCounter packet_counter_;
  IncrementInterval velocity_interval_, rotation_interval_;
  bool restarted_ = false;  // since the previous sample
  Counters counters_;
};

}  // namespace curbstone::imu::xsens
