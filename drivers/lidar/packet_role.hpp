#pragma once

#include "drivers/lidar/models/base/model.hpp"
#include "drivers/lidar/models/base/sender.hpp"
#include "drivers/lidar/sources/one_sender.hpp"

namespace curbstone::lidar {

/// What a packet is to the choice of the device. `model`: nullptr while it is unknown, then of any that it could be.
[[nodiscard]] inline sources::OneSender::Kind role_of(const models::Model* model, models::Sender sender) {
  using Kind = sources::OneSender::Kind;
  if (model != nullptr ? !model->is_own(sender) : !models::is_supported(sender)) return Kind::kForeign;
  return models::is_info(sender) ? Kind::kInfo : Kind::kPoints;
}

}  // namespace curbstone::lidar
