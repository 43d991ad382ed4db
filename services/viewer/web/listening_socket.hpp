#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace curbstone::viewer::web {

/// Another program listens there, or no interface has the address at present: waiting may help.
class NotFree : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Opens a TCP socket that listens at `address` (numeric IPv4 or IPv6), on the first free one of `ports` ports from
/// `port` on (0: any free port). `network`: file of the network namespace to listen in, such as /proc/PID/ns/net;
/// empty: the process's own. The bus of a demo has its own namespace, in which no browser runs; entering another
/// namespace needs CAP_SYS_ADMIN. Returns the descriptor, which the caller owns. Throws NotFree, another
/// std::runtime_error, or std::invalid_argument for what is no address, with a one-line message.
[[nodiscard]] int open_listening_socket(const std::string& address, std::uint16_t port, int ports,
                                        const std::string& network);

/// The port of a listening socket.
[[nodiscard]] std::uint16_t port_of(int socket);

}  // namespace curbstone::viewer::web
