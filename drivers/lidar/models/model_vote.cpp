#include "drivers/lidar/models/model_vote.hpp"

#include "drivers/lidar/models/helios/device_info.hpp"

namespace curbstone::lidar::models {

std::optional<ModelName> ModelVote::model_of(Sender sender) const {
  switch (sender) {
    case Sender::kRs16:
      return ModelName::kRs16;
    case Sender::kVlp16:
      return ModelName::kVlp16;
    case Sender::kHelios16p:
      return ModelName::kHelios16p;
    case Sender::kHelios32:
      return ModelName::kHelios32;
    case Sender::kHelios:
      if (helios_lasers_ == 16) return ModelName::kHelios16p;
      if (helios_lasers_ == 32) return ModelName::kHelios32;
      return std::nullopt;
    default:
      return std::nullopt;
  }
}

std::optional<ModelName> ModelVote::offer(std::span<const std::uint8_t> bytes) {
  const Sender sender = sender_of(bytes);
  if (sender == Sender::kHeliosInfo) {
    const helios::DifopResult info = helios::parse_difop(bytes);
    if (info.refusal == decoding::Refusal::kNone) helios_lasers_ = info.info.lasers;
    return std::nullopt;
  }
  if (sender == Sender::kRs16Info || sender == Sender::kVlp16Position || sender == Sender::kUnknown)
    return std::nullopt;
  votes_ = sender == leading_ ? votes_ + 1 : 1;
  leading_ = sender;
  return votes_ >= kAgreeing ? model_of(sender) : std::nullopt;
}

}  // namespace curbstone::lidar::models
