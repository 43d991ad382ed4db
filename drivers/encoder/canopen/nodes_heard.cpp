#include "drivers/encoder/canopen/nodes_heard.hpp"

#include <fmt/format.h>

#include "drivers/encoder/canopen/canopen.hpp"

namespace curbstone::encoder::canopen {

namespace {

constexpr std::uint32_t kNodeBits = 0x7F;

bool is_heartbeat(const can::CanFrame& frame) {
  if ((frame.id & ~kNodeBits) != kHeartbeat || frame.size != 1) return false;
  const auto state = static_cast<NmtState>(frame.data[0] & 0x7F);  // the upper bit toggles, in node guarding
  return state == NmtState::kBootUp || state == NmtState::kStopped || state == NmtState::kOperational ||
         state == NmtState::kPreOperational;
}

bool are_positions(const can::CanFrame& frame) {
  return (frame.id & ~kNodeBits) == kTpdo1 && frame.size == 8;
}

}  // namespace

void NodesHeard::add(const can::CanFrame& frame) {
  if (frame.extended || frame.remote) return;
  if (is_heartbeat(frame) || are_positions(frame)) nodes_.set(frame.id & kNodeBits);
}

std::string NodesHeard::instead_of(std::uint8_t node) const {
  if (nodes_.test(node & kNodeBits)) return {};
  std::string text;
  for (std::size_t other = 1; other < kNodes; ++other) {
    if (nodes_.test(other)) text += fmt::format("{}{}", text.empty() ? "; heard instead: CAN node " : ", ", other);
  }
  return text;
}

std::vector<std::uint32_t> NodesHeard::ids() {
  std::vector<std::uint32_t> ids;
  for (std::uint32_t node = 1; node < kNodes; ++node) ids.push_back(kHeartbeat + node);
  return ids;
}

}  // namespace curbstone::encoder::canopen
