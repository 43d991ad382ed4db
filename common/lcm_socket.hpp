#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace curbstone {

/// The socket from which LCM's udpm receives. LCM 1.3.1 keeps it to itself, opens it with the first subscription, wakes
/// a thread for each message on the bus, whoever wants it, and says nothing of what the kernel dropped.
class LcmSocket {
 public:
  /// Around the first subscription: `open` makes LCM open the socket.
  template <class Open>
  void find(Open open) {
    const std::vector<int> before = open_sockets();
    open();
    find_since(before);
  }
  [[nodiscard]] bool found() const { return fd_ >= 0; }

  /// From now on the kernel turns away messages on other channels, and nobody is woken for them.
  void pass_only(const std::vector<std::string>& channels);
  void pass_all();

  /// Datagrams that found the receive buffer full. Where others are turned away, the kernel counts those too: then it
  /// is no more than what it dropped at full buffers of all sockets on this host, since find().
  [[nodiscard]] std::int64_t dropped() const;

 private:
  static std::vector<int> open_sockets();
  void find_since(const std::vector<int>& before);

  int fd_ = -1;               // LCM's
  bool turned_away_ = false;  // some, at some time
  std::int64_t host_before_ = 0;
};

}  // namespace curbstone
