#pragma once

#include "drivers/lidar/models/base/confirmed_value.hpp"
#include "drivers/lidar/models/base/model.hpp"
#include "drivers/lidar/models/helios/helios_decoder.hpp"
#include "drivers/lidar/models/robosense/speed_watch.hpp"

namespace curbstone::lidar::models::helios {

/// A Helios with 16 or 32 lasers as a model. Its angles are those of the device: from its device information or from a
/// file. There is no nominal table, so there are no points before they are known. Two consecutive device informations
/// must agree. If only one will come, it counts if it is plausible.
class HeliosModel final : public Model {
 public:
  /// Throws std::runtime_error if the number of angles in the file is not that of the lasers.
  HeliosModel(const Variant& variant, const ModelSettings& settings);

  [[nodiscard]] const ModelTable& table() const override { return variant_.table; }
  [[nodiscard]] PacketKind kind_of(Sender sender) const override;
  [[nodiscard]] decoding::Refusal decode(std::int64_t received, std::span<const std::uint8_t> bytes,
                                         decoding::DecodedPacket& packet) override;
  [[nodiscard]] decoding::Refusal read_info(std::int64_t received, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] const DeviceFacts& facts() const override { return facts_; }

 private:
  void use(DeviceInfo info);
  void report_info(const DeviceInfo& info, const DeviceStatus& status);

  const Variant& variant_;
  ModelSettings settings_;
  HeliosDecoder decoder_;
  ConfirmedValue<DeviceInfo> info_;
  ConfirmedValue<Identity> identity_;
  robosense::SpeedWatch speed_;
  DeviceFacts facts_;
};

}  // namespace curbstone::lidar::models::helios
