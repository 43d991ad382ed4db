#pragma once

#include <linux/filter.h>

#include <cstdint>
#include <string>
#include <vector>

namespace curbstone {

/// The socket from which LCM's udpm receives. LCM 1.3.1 opens it with the first subscription and does not show it. It
/// wakes a thread for each message on the bus, wanted or not. It says nothing of what the kernel dropped. This class
/// finds the socket among those of the process, to filter it and to read its drop count.
class LcmSocket {
 public:
  /// `open` makes LCM open the socket, by the first subscription. Sockets that other threads open meanwhile can be
  /// mistaken for it: call it before there are such threads.
  template <class Open>
  void find(Open open) {
    const std::vector<int> before = open_sockets();
    open();
    find_since(before);
  }
  [[nodiscard]] bool found() const { return fd_ >= 0; }

  /// From this call on the kernel turns away messages on other channels, and what is no whole message (see
  /// channel_filter.hpp). Nobody is woken for them.
  void pass_only(const std::vector<std::string>& channels);
  /// Whole messages on any channel.
  void pass_all();

  /// Datagrams that found the receive buffer full, since find(). With pass_only() the kernel's count of this socket
  /// includes those turned away. Then the result is bounded by the drops at full buffers of all UDP sockets of this
  /// host.
  [[nodiscard]] std::int64_t dropped() const;

 private:
  [[nodiscard]] bool attach(std::vector<sock_filter> program) const;
  static std::vector<int> open_sockets();
  void find_since(const std::vector<int>& before);

  int fd_ = -1;               // LCM's
  bool turned_away_ = false;  // some, at some time
  std::int64_t host_before_ = 0;
};

}  // namespace curbstone
