#pragma once

#include <cstdint>
#include <span>

#include "common/bytes/little_endian.hpp"
#include "drivers/encoder/can/can_frame.hpp"

namespace curbstone::encoder::canopen {

// CiA 301: the predefined connection set (ids are base + node), little-endian payloads.
inline constexpr std::uint32_t kNmt = 0x000;
inline constexpr std::uint32_t kSync = 0x080;
inline constexpr std::uint32_t kEmergency = 0x080;
inline constexpr std::uint32_t kTpdo1 = 0x180;
inline constexpr std::uint32_t kTpdo2 = 0x280;
inline constexpr std::uint32_t kSdoReply = 0x580;
inline constexpr std::uint32_t kSdoRequest = 0x600;
inline constexpr std::uint32_t kHeartbeat = 0x700;

enum class NmtCommand : std::uint8_t {
  kStart = 0x01,
  kStop = 0x02,
  kPreOperational = 0x80,
  kResetNode = 0x81,
  kResetCommunication = 0x82,
};
enum class NmtState : std::uint8_t { kBootUp = 0x00, kStopped = 0x04, kOperational = 0x05, kPreOperational = 0x7F };

/// First byte of an expedited SDO.
enum class SdoCommand : std::uint8_t {
  kRead = 0x40,
  kReadReply4 = 0x43,
  kReadReply3 = 0x47,
  kReadReply2 = 0x4B,
  kReadReply1 = 0x4F,
  kReadReplyUnsized = 0x42,
  kWrite4 = 0x23,
  kWrite3 = 0x27,
  kWrite2 = 0x2B,
  kWrite1 = 0x2F,
  kWriteReply = 0x60,
  kAbort = 0x80,
};
inline constexpr std::uint32_t kAbortTimeout = 0x05040000;
inline constexpr std::uint32_t kAbortNoObject = 0x06020000;
inline constexpr std::uint32_t kAbortReadOnly = 0x06010002;
inline constexpr std::uint32_t kAbortNoSubIndex = 0x06090011;
inline constexpr std::uint32_t kAbortLength = 0x06070010;
inline constexpr std::uint32_t kAbortUnknownCommand = 0x05040001;

/// An entry of the object dictionary: index and sub-index.
struct Object {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  auto operator<=>(const Object&) const = default;
};

/// An object of `bits` bits as encoded in a PDO's mapping.
[[nodiscard]] constexpr std::uint32_t mapping(Object object, std::uint8_t bits) {
  return std::uint32_t{object.index} << 16 | std::uint32_t{object.sub} << 8 | bits;
}

[[nodiscard]] inline can::CanFrame nmt(NmtCommand command, std::uint8_t node) {
  return can::CanFrame::make(kNmt, {static_cast<std::uint8_t>(command), node});
}

/// An SDO frame is always 8 bytes: command, index, sub-index, data.
[[nodiscard]] inline can::CanFrame sdo(std::uint32_t id, SdoCommand command, Object object, std::uint32_t data) {
  can::CanFrame frame =
      can::CanFrame::make(id, {static_cast<std::uint8_t>(command), static_cast<std::uint8_t>(object.index),
                               static_cast<std::uint8_t>(object.index >> 8), object.sub, 0, 0, 0, 0});
  write_little_endian(std::span(frame.data).subspan(4), data);
  return frame;
}

}  // namespace curbstone::encoder::canopen
