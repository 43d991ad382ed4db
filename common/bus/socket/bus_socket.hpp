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

#include "common/bus/socket/bus_address.hpp"
#include "common/bus/socket/fragment_assembler.hpp"

namespace curbstone {

/// The socket on which a process receives the bus. It implements LCM's wire format (LCM 1.3.1, `lcm_udpm.c`) but does
/// not use LCM's receiver. LCM's receiver writes out of bounds on a fragment with a false offset, accepts any size,
/// receives other groups on the same port, wakes three threads for each message, and does not report what the kernel
/// dropped. Here a message is a single datagram: none of Curbstone's messages is longer, and FragmentAssembler handles
/// longer messages of other programs. The kernel discards messages that no subscriber wants (channel_filter.hpp), and
/// every datagram that finds this socket's buffer full is counted. Initially nothing passes: call pass_only() or
/// pass_all().
class BusSocket {
 public:
  struct Message {
    std::string_view channel;
    std::span<const std::uint8_t> bytes;
    std::int64_t utime = 0;  ///< us since the Unix epoch, when the kernel received it
    std::uint16_t port = 0;  ///< UDP port of its sender
  };
  using Handler = std::function<void(const Message&)>;

  /// Joins the group. Throws std::runtime_error with the kernel's reason. `large_channels`: channels on which
  /// pass_all() also receives messages of more than 64 kB, which are reassembled here.
  explicit BusSocket(const BusAddress& address, const std::vector<std::string>& large_channels = {});
  ~BusSocket();
  BusSocket(const BusSocket&) = delete;
  BusSocket& operator=(const BusSocket&) = delete;

  /// From this call on the kernel discards messages on other channels and datagrams that are not whole messages. They
  /// do not wake the process.
  void pass_only(const std::vector<std::string>& channels);
  /// Passes whole messages on any channel, and also fragments if there are large channels.
  void pass_all();

  /// Joins the group on the interface to which its route leads now, if that is another one: an interface that was
  /// removed and made again is another one. To be called by the receiving thread, from time to time.
  void follow_route();

  /// For poll().
  [[nodiscard]] int fd() const { return fd_; }
  /// Passes the datagrams that have arrived, at most 32, to `handler`. The data is valid until the handler returns.
  /// Returns whether more may have arrived. One thread.
  bool receive(const Handler& handler);

  /// Datagrams that found the receive buffer full. Any thread. Exact if called once a second. The kernel counts such
  /// drops per socket only together with the datagrams that the filter discards; it counts them separately only for all
  /// UDP sockets of the host. Therefore the increase of the host's count is attributed to this socket for the times at
  /// which its buffer was seen more than half full, or if the buffer is too small to tell.
  [[nodiscard]] std::int64_t dropped();
  /// Datagrams since pass_all() that were not whole messages. 0 without pass_all(), because the kernel then counts them
  /// together with the messages that no subscriber wants.
  [[nodiscard]] std::int64_t refused();
  /// The count of refused fragments from FragmentAssembler. Any thread.
  [[nodiscard]] std::int64_t refused_fragments() const { return refused_fragments_.load(); }
  [[nodiscard]] std::int64_t dropped_large() const { return dropped_large_.load(); }

 private:
  struct Batch;
  struct Buffer {
    std::uint32_t size = 0;          // bytes
    std::uint32_t used = 0;          // bytes
    std::uint32_t kernel_drops = 0;  // datagrams, for any reason
  };
  void attach(std::vector<sock_filter> program);
  void take_fragment(std::uint64_t sender, std::span<const std::uint8_t> datagram, std::int64_t utime,
                     const Handler& handler);
  [[nodiscard]] Buffer look_at_buffer() const;
  void note_drops(bool is_host_wanted);

  const BusAddress address_;
  int fd_ = -1;
  bool tells_ = false;  // whether the buffer is large enough to observe how full it is
  std::unique_ptr<Batch> batch_;
  std::optional<FragmentAssembler> assembler_;  // used by the receiving thread only
  std::atomic<std::int64_t> refused_fragments_ = 0;
  std::atomic<std::int64_t> dropped_large_ = 0;
  std::mutex filter_mutex_;
  std::vector<sock_filter> filter_;  // of the socket
  std::mutex mutex_;                 // guards everything below
  bool filled_ = false;
  std::int64_t host_drops_ = 0;  // the host's count at the last look
  std::int64_t dropped_ = 0;
  bool passes_all_ = false;
  std::uint32_t kernel_drops_before_ = 0;  // this socket's count at pass_all()
  std::int64_t dropped_before_ = 0;
};

}  // namespace curbstone
