#pragma once

#include <linux/filter.h>

#include <string>
#include <vector>

namespace curbstone {

/// Classic BPF programs for the socket that receives LCM's udpm. They pass whole messages and nothing else. A whole
/// message is one datagram of at most 65,499 bytes: "LC02", sequence number, channel, 0, data (LCM 1.3.1, `lcm_udpm.c`,
/// big-endian). No message of Curbstone is longer. Fragments ("LC03") of longer messages are discarded: LCM 1.3.1
/// writes out of bounds when a fragment's offset lies outside its message, and it accepts any size up to 256 MiB. A
/// socket filter sees the datagram from its UDP header on. Reference: Linux Documentation/networking/filter.rst.

/// Passes messages on these channels only, so that other messages do not wake the process: most messages on a vehicle's
/// bus are not for most of its processes.
[[nodiscard]] std::vector<sock_filter> make_channel_filter(std::vector<std::string> channels);

/// Passes messages on any channel whose name has 1 to 63 bytes and ends within the datagram. `with_fragments`: also
/// passes fragments of larger messages, for a receiver that reassembles them itself (fragment_assembler.hpp).
[[nodiscard]] std::vector<sock_filter> make_message_filter(bool with_fragments = false);

}  // namespace curbstone
