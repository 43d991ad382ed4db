#pragma once

#include <linux/filter.h>

#include <string>
#include <vector>

namespace curbstone {

/// A classic BPF program for the receiving socket of LCM's udpm. It lets only messages on these channels through, so
/// that the process is not woken for the others: most messages on a vehicle's bus are not for most of its processes.
/// Datagrams that do not begin a message pass too. A socket filter sees the datagram from its UDP header on.
/// Format (LCM 1.3.1, `lcm_udpm.c`, big-endian): a short message is "LC02", sequence number, channel, 0, data. A longer
/// one is sent in fragments: "LC03", sequence number, size, offset, fragment number, fragment count, and in the first
/// fragment channel, 0. Reference: Linux Documentation/networking/filter.rst.
[[nodiscard]] std::vector<sock_filter> make_channel_filter(std::vector<std::string> channels);

}  // namespace curbstone
