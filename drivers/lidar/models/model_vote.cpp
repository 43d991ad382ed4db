#include "drivers/lidar/models/model_vote.hpp"

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

void ModelVote::read_info(std::span<const std::uint8_t> bytes) {
  const helios::DifopResult result = helios::parse_difop(bytes);
  if (result.refusal != decoding::Refusal::kNone) return;
  const bool alone = only_info_ && helios::is_plausible(result.info, result.status);
  if (info_.offer(result.info) || alone) helios_lasers_ = result.info.lasers;
}

std::optional<ModelName> ModelVote::offer(std::span<const std::uint8_t> bytes) {
  const Sender sender = sender_of(bytes);
  if (sender == Sender::kHeliosInfo) {
    read_info(bytes);
    return std::nullopt;
  }
  if (is_info(sender) || sender == Sender::kUnknown) return std::nullopt;
  if (!is_supported(sender)) {  // it may send beside the device, but can be none
    if (votes_ == 0) leading_ = sender;
    return std::nullopt;
  }
  votes_ = sender == leading_ ? votes_ + 1 : 1;
  leading_ = sender;
  return votes_ >= kAgreeing ? model_of(sender) : std::nullopt;
}

}  // namespace curbstone::lidar::models
