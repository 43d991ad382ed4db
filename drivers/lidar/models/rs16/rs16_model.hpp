#pragma once

#include "drivers/lidar/models/base/confirmed_value.hpp"
#include "drivers/lidar/models/base/model.hpp"
#include "drivers/lidar/models/robosense/speed_watch.hpp"
#include "drivers/lidar/models/rs16/rs16_decoder.hpp"

namespace curbstone::lidar::models::rs16 {

extern const ModelTable kTable;

/// The RS-LiDAR-16 as a model: its decoder and its device information. Without device information the nominal
/// elevations are used, unless the user chose to wait for it.
class Rs16Model final : public Model {
 public:
  /// Throws std::runtime_error if there are not 16 angles.
  explicit Rs16Model(const ModelSettings& settings);

  [[nodiscard]] const ModelTable& table() const override { return kTable; }
  [[nodiscard]] PacketKind kind_of(Sender sender) const override;
  [[nodiscard]] decoding::Refusal decode(std::int64_t received, std::span<const std::uint8_t> bytes,
                                         decoding::DecodedPacket& packet) override;
  [[nodiscard]] decoding::Refusal read_info(std::int64_t received, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] const DeviceFacts& facts() const override { return facts_; }

 private:
  [[nodiscard]] DeviceInfo with_settings(DeviceInfo info) const;
  void report_info(const DeviceInfo& info, const DeviceStatus& status);
  [[nodiscard]] bool has_two_returns(const decoding::DecodedPacket& packet);

  ModelSettings settings_;
  Rs16Decoder decoder_;
  ConfirmedValue<DeviceInfo> info_;
  ConfirmedValue<Identity> identity_;
  robosense::SpeedWatch speed_;
  DeviceFacts facts_;
  std::int64_t stamp_ = 0;  // us, of the previous packet
  int azimuth_ = 0;         // 0.01 deg, likewise
  int halves_ = 0;          // consecutive packets that took half the time of single-return ones
};

}  // namespace curbstone::lidar::models::rs16
