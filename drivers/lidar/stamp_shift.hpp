#pragma once

#include <cstdint>
#include <span>

namespace curbstone::lidar {

/// Sets the device's own stamp of a point packet forward by `shift` us, in the layout of its maker: RS16, Helios or
/// VLP-16, recognised by length and first bytes. Anything else, and a stamp that is out of range, stays as it is. For a
/// capture that is played again: its stamps go on where they ended.
void shift_stamp(std::span<std::uint8_t> packet, std::int64_t shift);

}  // namespace curbstone::lidar
