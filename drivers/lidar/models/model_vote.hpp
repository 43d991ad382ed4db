#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "drivers/lidar/models/base/sender.hpp"
#include "drivers/lidar/models/make_model.hpp"

namespace curbstone::lidar::models {

/// Finds out which model is there (`model: auto`): kAgreeing point packets in a row of one. A Helios whose type byte is
/// shared by those of 16 and 32 lasers is known once its device information has said how many it has. Pure.
class ModelVote {
 public:
  static constexpr int kAgreeing = 5;

  /// The next packet. Returns the model once it is decided.
  std::optional<ModelName> offer(std::span<const std::uint8_t> bytes);

  /// Whom the last packets are from.
  [[nodiscard]] Sender leading() const { return leading_; }

 private:
  [[nodiscard]] std::optional<ModelName> model_of(Sender sender) const;

  Sender leading_ = Sender::kUnknown;
  int votes_ = 0;
  int helios_lasers_ = 0;  ///< as its device information says; 0 = not known
};

}  // namespace curbstone::lidar::models
