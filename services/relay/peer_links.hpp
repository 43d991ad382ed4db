#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/counters.hpp"

namespace curbstone::relay {

struct Frame;

/// The UDP socket to the relays of the other hosts. Nothing here blocks: an unreachable peer only loses its datagrams.
/// One thread.
class PeerLinks {
 public:
  using Handler = std::function<void(std::string_view channel, std::span<const std::uint8_t> data)>;

  /// `run`: differs at each start and on each host. The peers may include this host, so that all hosts can have one
  /// list: a peer from which the relay hears its own run is skipped. Throws std::system_error with the kernel's reason:
  /// the port is taken.
  PeerLinks(int port, const std::vector<sockaddr_in>& peers, std::uint64_t run);
  ~PeerLinks();
  PeerLinks(const PeerLinks&) = delete;
  PeerLinks& operator=(const PeerLinks&) = delete;

  /// For poll().
  [[nodiscard]] int fd() const { return fd_; }
  /// Sends to every peer. Without a channel the datagram is a heartbeat.
  void send(std::string_view channel, std::span<const std::uint8_t> data);
  /// Passes the messages that have arrived from peers to `handler`, at most 64 datagrams. `now`: us.
  void receive(std::int64_t now, const Handler& handler);

  /// Peers that have been silent for `for_us`, us, since they were last heard or since `start`.
  [[nodiscard]] std::vector<std::string> silent(std::int64_t now, std::int64_t start, std::int64_t for_us) const;
  /// lost.peer: datagrams that peers sent and that did not arrive. dropped.peer: datagrams that the kernel did not
  /// accept. refused.datagram: datagrams that are not from peers, or not frames.
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Peer {
    sockaddr_in address{};
    std::uint32_t sent = 0;                  // datagrams: number of the next one
    std::optional<std::int64_t> last_heard;  // us
    std::uint64_t run = 0;
    std::uint32_t next = 0;  // number expected after the newest datagram
    bool is_self = false;
  };
  [[nodiscard]] Peer* find(const sockaddr_in& address);
  void note_number(Peer& peer, const Frame& frame, std::int64_t now);

  int fd_ = -1;
  std::uint64_t run_;
  std::vector<Peer> peers_;
  std::unique_ptr<std::uint8_t[]> buffer_;
  Counters counters_;
};

}  // namespace curbstone::relay
