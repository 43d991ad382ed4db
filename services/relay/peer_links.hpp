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

/// The UDP socket to the relays of the other hosts. A peer that cannot be reached costs its datagrams and nothing else:
/// nothing here waits. One thread.
class PeerLinks {
 public:
  using Handler = std::function<void(std::string_view channel, std::span<const std::uint8_t> data)>;

  /// `run`: another one at each start and on each host. Peers may name this host too: it is left out once it has heard
  /// itself, so that all hosts can have one list. Throws std::system_error with the kernel's reason: the port is taken.
  PeerLinks(int port, const std::vector<sockaddr_in>& peers, std::uint64_t run);
  ~PeerLinks();
  PeerLinks(const PeerLinks&) = delete;
  PeerLinks& operator=(const PeerLinks&) = delete;

  /// For poll().
  [[nodiscard]] int fd() const { return fd_; }
  /// To every peer. Without a channel it is a sign of life.
  void send(std::string_view channel, std::span<const std::uint8_t> data);
  /// Hands over the messages of what has come from peers, 64 datagrams at most. `now`: us.
  void receive(std::int64_t now, const Handler& handler);

  /// Peers from whom nothing has come for so long, us, since they were heard or since `start`.
  [[nodiscard]] std::vector<std::string> silent(std::int64_t now, std::int64_t start, std::int64_t for_us) const;
  /// lost.peer: datagrams that peers sent and that did not come. dropped.peer: those that the kernel did not take.
  /// refused.datagram: of others than peers, or no frames.
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Peer {
    sockaddr_in address{};
    std::uint32_t sent = 0;                  // datagrams: the next one's number
    std::optional<std::int64_t> last_heard;  // us
    std::uint64_t run = 0;
    std::uint32_t next = 0;  // number of the datagram after the newest
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
