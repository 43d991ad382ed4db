#pragma once

#include <linux/filter.h>

#include <string>
#include <vector>

namespace curbstone {

/// A classic BPF program for the receiving socket of LCM's udpm that lets only messages on these channels through, so
/// that nobody is woken for the others: on a vehicle most of what goes over the bus is not for most of its processes.
/// What is no message's first (or only) datagram passes too. The datagram begins with its UDP header, as a socket
/// filter sees it. LCM's format: `lcm_udpm.c`; short messages "LC02", sequence number, channel, 0; longer ones "LC03",
/// sequence number, size, offset, fragment's number and count, and in the first fragment channel, 0.
[[nodiscard]] std::vector<sock_filter> make_channel_filter(std::vector<std::string> channels);

}  // namespace curbstone
