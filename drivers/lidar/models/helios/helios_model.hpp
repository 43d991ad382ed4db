#pragma once

#include "drivers/lidar/models/base/agreed.hpp"
#include "drivers/lidar/models/base/model.hpp"
#include "drivers/lidar/models/helios/helios_decoder.hpp"

namespace curbstone::lidar::models::helios {

/// A Helios of 16 or 32 lasers as a model. Its angles are its own: from its device information or from a file. There is
/// no nominal table, so no points come before they are known. Two device informations in a row must agree. Where but
/// one will come, it counts if it is plausible.
class HeliosModel final : public Model {
 public:
  /// Throws std::runtime_error where the file's angles are not as many as the lasers.
  HeliosModel(const Variant& variant, const ModelSettings& settings);

  [[nodiscard]] const ModelTable& table() const override { return variant_.table; }
  [[nodiscard]] PacketKind kind_of(Sender sender) const override;
  [[nodiscard]] decoding::Refusal decode(std::int64_t received, std::span<const std::uint8_t> bytes,
                                         decoding::DecodedPacket& packet) override;
  [[nodiscard]] decoding::Refusal read_info(std::int64_t received, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] const DeviceFacts& facts() const override { return facts_; }

 private:
  void use(DeviceInfo info);
  void tell(const DeviceInfo& info, const DeviceStatus& status);

  const Variant& variant_;
  ModelSettings settings_;
  HeliosDecoder decoder_;
  Agreed<DeviceInfo> info_;
  DeviceFacts facts_;
};

}  // namespace curbstone::lidar::models::helios
