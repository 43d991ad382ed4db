#include "services/viewer/web/listening_socket.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <system_error>

namespace curbstone::viewer::web {
namespace {

std::runtime_error failure(const std::string& what) {
  return std::runtime_error(what + ": " + std::generic_category().message(errno));
}

/// Moves the calling thread into another network namespace while it exists.
class NetworkVisit {
 public:
  explicit NetworkVisit(const std::string& network) {
    if (network.empty()) return;
    home_ = open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC);
    const int there = open(network.c_str(), O_RDONLY | O_CLOEXEC);
    const bool is_there = home_ >= 0 && there >= 0 && setns(there, CLONE_NEWNET) == 0;
    const int error = errno;
    if (there >= 0) close(there);
    if (is_there) return;
    if (home_ >= 0) close(home_);
    errno = error;
    throw failure(network + ": not a network to listen in");
  }
  ~NetworkVisit() {
    if (home_ < 0) return;
    // A failure is ignored: the bus is opened before, and no other socket is opened later.
    (void)!setns(home_, CLONE_NEWNET);
    close(home_);
  }
  NetworkVisit(const NetworkVisit&) = delete;
  NetworkVisit& operator=(const NetworkVisit&) = delete;

 private:
  int home_ = -1;
};

struct Address {
  sockaddr_storage bytes{};
  socklen_t size = 0;
};

Address parse_address(const std::string& text, std::uint16_t port) {
  Address address;
  auto* v4 = reinterpret_cast<sockaddr_in*>(&address.bytes);
  auto* v6 = reinterpret_cast<sockaddr_in6*>(&address.bytes);
  if (inet_pton(AF_INET, text.c_str(), &v4->sin_addr) == 1) {
    v4->sin_family = AF_INET;
    v4->sin_port = htons(port);
    address.size = sizeof *v4;
  } else if (inet_pton(AF_INET6, text.c_str(), &v6->sin6_addr) == 1) {
    v6->sin6_family = AF_INET6;
    v6->sin6_port = htons(port);
    address.size = sizeof *v6;
  } else {
    throw std::invalid_argument("viewer.address: '" + text +
                                "' is no address to listen at; expected one like 127.0.0.1 or ::1");
  }
  return address;
}

/// Returns -1 and sets errno on failure.
int listen_at(const Address& where) {
  const int fd = socket(where.bytes.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return -1;
  const int yes = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (bind(fd, reinterpret_cast<const sockaddr*>(&where.bytes), where.size) != 0 || listen(fd, 64) != 0) {
    const int error = errno;
    close(fd);
    errno = error;
    return -1;
  }
  return fd;
}

}  // namespace

int open_listening_socket(const std::string& address, std::uint16_t port, int ports, const std::string& network) {
  const NetworkVisit visit(network);
  for (int i = 0;; ++i) {
    const int fd = listen_at(parse_address(address, static_cast<std::uint16_t>(port + i)));
    if (fd >= 0) return fd;
    const bool is_last = i + 1 >= ports || port + i == std::numeric_limits<std::uint16_t>::max();
    if (errno == EADDRINUSE && !is_last) continue;
    const char* const help = errno == EADDRINUSE      ? " (`ss -tlnp` shows by whom)"
                             : errno == EADDRNOTAVAIL ? " (`ip address` shows which there are)"
                                                      : nullptr;
    const std::string first = i > 0 ? "s " + std::to_string(port) + " to " : " ";
    const std::runtime_error error = failure(address + ", port" + first + std::to_string(port + i));
    if (help != nullptr) throw NotFree(std::string(error.what()) + help);
    throw error;
  }
}

std::uint16_t port_of(int socket) {
  sockaddr_storage bytes{};
  socklen_t size = sizeof bytes;
  getsockname(socket, reinterpret_cast<sockaddr*>(&bytes), &size);
  return bytes.ss_family == AF_INET6 ? ntohs(reinterpret_cast<const sockaddr_in6&>(bytes).sin6_port)
                                     : ntohs(reinterpret_cast<const sockaddr_in&>(bytes).sin_port);
}

}  // namespace curbstone::viewer::web
