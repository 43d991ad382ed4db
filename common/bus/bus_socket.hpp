#pragma once

#include <linux/filter.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus_address.hpp"
#include "common/bus/fragment_assembler.hpp"

namespace curbstone {

/// The socket on which a process hears the bus: LCM's wire format (LCM 1.3.1, `lcm_udpm.c`), not LCM's receiver. That
/// one writes out of bounds when a fragment lies, believes any size, hears other groups of the same port, wakes three
/// threads for a message, and says nothing of what the kernel dropped. Here messages are single datagrams (no message
/// of ours is longer; FragmentAssembler is for those of others), what nobody asked for is turned away in the kernel
/// (channel_filter.hpp), and each datagram that found this socket's buffer full is counted. At first nothing passes:
/// call pass_only() or pass_all().
class BusSocket {
 public:
  struct Message {
    std::string_view channel;
    std::span<const std::uint8_t> bytes;
    std::int64_t utime = 0;  ///< us since the Unix epoch, when the kernel had it
    std::uint16_t port = 0;  ///< UDP port of its sender
  };
  using Handler = std::function<void(const Message&)>;

  /// Joins the group. Throws std::runtime_error with the kernel's reason. `large_channels`: on which pass_all() also
  /// hears messages of more than 64 kB, put together here.
  explicit BusSocket(const BusAddress& address, const std::vector<std::string>& large_channels = {});
  ~BusSocket();
  BusSocket(const BusSocket&) = delete;
  BusSocket& operator=(const BusSocket&) = delete;

  /// From this call on the kernel turns away messages on other channels, and what is no whole message. Nobody is woken
  /// for them.
  void pass_only(const std::vector<std::string>& channels);
  /// Whole messages on any channel, and the fragments of large ones if some are wanted.
  void pass_all();

  /// For poll().
  [[nodiscard]] int fd() const { return fd_; }
  /// Hands over what has come, 32 messages at most. What it hands over is good until the handler returns. One thread.
  void receive(const Handler& handler);

  /// Datagrams that found the receive buffer full. Any thread; asked once a second it is exact: the kernel counts them
  /// for a socket together with those that the filter turns away, and alone only for all UDP sockets of the host. So
  /// the host's count is taken over from times in which this buffer was seen more than half full, or is too small to
  /// tell.
  [[nodiscard]] std::int64_t dropped();
  /// Datagrams that were no whole message, since pass_all(); 0 without it, because then they are among those that
  /// nobody asked for.
  [[nodiscard]] std::int64_t refused();
  /// Of FragmentAssembler. Any thread.
  [[nodiscard]] std::int64_t refused_fragments() const { return refused_fragments_.load(); }
  [[nodiscard]] std::int64_t dropped_large() const { return dropped_large_.load(); }

 private:
  struct Batch;
  struct Buffer {
    std::uint32_t size = 0;          // bytes
    std::uint32_t used = 0;          // bytes
    std::uint32_t kernel_drops = 0;  // datagrams, for whatever reason
  };
  void attach(const std::vector<sock_filter>& program);
  void take_fragment(std::uint64_t sender, std::span<const std::uint8_t> datagram, std::int64_t utime,
                     const Handler& handler);
  [[nodiscard]] Buffer look_at_buffer() const;
  void note_drops(bool is_host_wanted);

  int fd_ = -1;
  bool tells_ = false;  // whether the buffer is large enough to be seen filling
  std::unique_ptr<Batch> batch_;
  std::optional<FragmentAssembler> assembler_;  // of who receives
  std::atomic<std::int64_t> refused_fragments_ = 0;
  std::atomic<std::int64_t> dropped_large_ = 0;
  std::mutex mutex_;  // of all below
  bool filled_ = false;
  std::int64_t host_drops_ = 0;  // when looked at last
  std::int64_t dropped_ = 0;
  bool passes_all_ = false;
  std::uint32_t kernel_drops_before_ = 0;  // pass_all()
  std::int64_t dropped_before_ = 0;
};

}  // namespace curbstone
