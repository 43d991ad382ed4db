#pragma once

#include <bitset>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/encoder/can/can_frame.hpp"

namespace curbstone::encoder::canopen {

/// The CANopen nodes on a bus by what they send without being asked: heartbeats, boot-ups and positions. For the fault
/// of a node id that nobody has. Pure.
class NodesHeard {
 public:
  void add(const can::CanFrame& frame);
  void forget() { nodes_.reset(); }
  /// "; heard instead: CAN node 2, 5"; empty if this node or none is heard.
  [[nodiscard]] std::string instead_of(std::uint8_t node) const;
  /// Of the heartbeats of all nodes, for a source that passes on only the ids that it is told.
  [[nodiscard]] static std::vector<std::uint32_t> ids();

 private:
  static constexpr std::size_t kNodes = 128;  // CiA 301: 1 to 127
  std::bitset<kNodes> nodes_;
};

}  // namespace curbstone::encoder::canopen
