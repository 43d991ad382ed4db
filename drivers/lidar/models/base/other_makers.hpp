#pragma once

#include <cstdint>
#include <span>

#include "drivers/lidar/models/base/sender.hpp"

namespace curbstone::lidar::models {

/// kHesai, kOuster or kLivox if a packet certainly is one of that maker's, else kUnknown. There are no checksums to ask
/// (Livox's covers a part only), so the whole layout has to fit the length; what fits none is not named. Any bytes are
/// allowed.
[[nodiscard]] Sender other_maker_of(std::span<const std::uint8_t> bytes);

}  // namespace curbstone::lidar::models
