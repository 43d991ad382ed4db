#pragma once

#include "drivers/lidar/models/base/model.hpp"
#include "drivers/lidar/models/vlp16/vlp16_decoder.hpp"

namespace curbstone::lidar::models::vlp16 {

extern const ModelTable kTable;

/// The VLP-16 as a model: its decoder, and the state of PPS and GPS from its position packets. Its angles are those of
/// the manual, for all devices; a file may correct them.
class Vlp16Model final : public Model {
 public:
  /// Throws std::runtime_error if there are not 16 angles.
  explicit Vlp16Model(const ModelSettings& settings);

  [[nodiscard]] const ModelTable& table() const override { return kTable; }
  [[nodiscard]] PacketKind kind_of(Sender sender) const override;
  [[nodiscard]] decoding::Refusal decode(std::int64_t received, std::span<const std::uint8_t> bytes,
                                         decoding::DecodedPacket& packet) override;
  [[nodiscard]] decoding::Refusal read_info(std::int64_t received, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] const DeviceFacts& facts() const override { return facts_; }

 private:
  Vlp16Decoder decoder_;
  DeviceFacts facts_;
};

/// Whether a text is a GPRMC sentence of a GPS with a fix: status A, and a valid checksum.
[[nodiscard]] bool is_valid_gprmc(std::string_view text);

}  // namespace curbstone::lidar::models::vlp16
