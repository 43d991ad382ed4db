#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "drivers/lidar/models/base/confirmed_value.hpp"
#include "drivers/lidar/models/base/sender.hpp"
#include "drivers/lidar/models/helios/device_info.hpp"
#include "drivers/lidar/models/make_model.hpp"

namespace curbstone::lidar::models {

/// Identifies the model (`model: auto`) by kAgreeing consecutive point packets of one model. A Helios whose type byte
/// does not distinguish 16 from 32 lasers is identified when two consecutive device informations agree: they have the
/// number. One may be damaged. Pure.
class ModelVote {
 public:
  static constexpr int kAgreeing = 5;

  /// Takes the next packet. Returns the model once it is identified.
  std::optional<ModelName> offer(std::span<const std::uint8_t> bytes);

  /// Only one device information will come: it counts if it is plausible.
  void expect_one_info() { only_info_ = true; }

  /// Sender of the latest packets.
  [[nodiscard]] Sender leading() const { return leading_; }

 private:
  [[nodiscard]] std::optional<ModelName> model_of(Sender sender) const;
  void read_info(std::span<const std::uint8_t> bytes);

  Sender leading_ = Sender::kUnknown;
  int votes_ = 0;
  bool only_info_ = false;
  ConfirmedValue<helios::DeviceInfo> info_;
  int helios_lasers_ = 0;  ///< reported by its device information; 0 = unknown
};

}  // namespace curbstone::lidar::models
