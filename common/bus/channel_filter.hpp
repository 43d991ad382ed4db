#pragma once

#include <linux/filter.h>

#include <string>
#include <vector>

namespace curbstone {

/// Classic BPF programs for the receiving socket of LCM's udpm, which let whole messages through and nothing else. A
/// whole message is one datagram, up to 65,499 bytes: "LC02", sequence number, channel, 0, data (LCM 1.3.1,
/// `lcm_udpm.c`, big-endian). No message of ours is longer. The fragments ("LC03") of longer ones are turned away:
/// LCM 1.3.1 writes out of bounds when a fragment's offset lies outside its message, and believes any size up to
/// 256 MiB. A socket filter sees the datagram from its UDP header on. Reference: Linux
/// Documentation/networking/filter.rst.

/// Messages on these channels only, so that the process is not woken for the others: most messages on a vehicle's bus
/// are not for most of its processes.
[[nodiscard]] std::vector<sock_filter> make_channel_filter(std::vector<std::string> channels);

/// Messages on any channel whose name has 1 to 63 bytes and ends within the datagram. `with_fragments`: those of larger
/// messages too, for who puts them together himself (fragment_assembler.hpp).
[[nodiscard]] std::vector<sock_filter> make_message_filter(bool with_fragments = false);

}  // namespace curbstone
