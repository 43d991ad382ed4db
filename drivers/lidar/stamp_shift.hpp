#pragma once

#include <cstdint>
#include <span>

namespace curbstone::lidar {

/// Advances the device's own stamp of a point packet by `shift` us, in the layout of its maker: RS16, Helios or VLP-16,
/// recognised by length and first bytes. Other packets, and stamps that are out of range, are not changed. For a
/// capture that is played again: its stamps continue where they ended.
void shift_stamp(std::span<std::uint8_t> packet, std::int64_t shift);

}  // namespace curbstone::lidar
