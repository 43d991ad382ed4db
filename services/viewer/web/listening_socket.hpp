#pragma once

#include <cstdint>
#include <string>

namespace curbstone::viewer::web {

/// Opens a TCP socket that listens at `address` (IPv4 or IPv6, as numbers) and the first of `ports` ports from `port`
/// on that nobody has (0: any that is free). `network` is the file of the network namespace to listen in, as
/// /proc/PID/ns/net; empty: the process's own. The bus of a demo has a namespace of its own, in which no browser runs;
/// entering another one needs CAP_SYS_ADMIN. Returns the descriptor, which the caller owns. Throws std::runtime_error
/// with one clear line.
[[nodiscard]] int open_listening_socket(const std::string& address, std::uint16_t port, int ports,
                                        const std::string& network);

/// Of a socket that listens.
[[nodiscard]] std::uint16_t port_of(int socket);

}  // namespace curbstone::viewer::web
