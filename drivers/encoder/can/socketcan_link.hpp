#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/time/retry_backoff.hpp"
#include "drivers/encoder/can/can_link.hpp"
#include "drivers/encoder/can/can_restart.hpp"

namespace curbstone::encoder::can {

/// This kernel has no CAN, or the name is not valid for an interface: only the config can fix that.
class NoSocketCan : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A raw SocketCAN socket (Linux Documentation/networking/can.rst). Receives exactly the given ids (bit 31 marks a
/// 29-bit id) and the bus's error frames. Non-blocking. Move-only; closed by the destructor.
class CanSocket {
 public:
  /// Throws with a one-line message: NoSocketCan, or std::runtime_error (no such interface, it is down, no permission).
  CanSocket(const std::string& interface, const std::vector<std::uint32_t>& ids);
  ~CanSocket();
  CanSocket(CanSocket&& other) noexcept;
  CanSocket& operator=(CanSocket&& other) noexcept;

  enum class Status { kFrame, kErrorFrame, kRefused, kNothing, kDown };
  struct Read {
    Status status = Status::kNothing;
    CanFrame frame;
    std::int64_t utime = 0;        ///< us, kernel time of receipt
    std::uint32_t error_bits = 0;  ///< of an error frame: CAN_ERR_*
  };
  [[nodiscard]] Read read();
  /// Returns false if the kernel has no room for it, or the interface is down.
  bool write(const CanFrame& frame);
  [[nodiscard]] int fd() const { return fd_; }

 private:
  void close() noexcept;
  int fd_ = -1;
};

/// A CAN interface of the kernel (can0). Bus-off, and an interface that goes down or disappears, are faults and
/// counted. After a bus-off the link restarts the interface, first after 0.1 s, then with a back-off of up to 2 s until
/// a frame is received. It reopens a lost interface with a back-off from 0.1 s to 2 s.
///
/// Counts: can.frames, can.errors, can.bus_off, can.restarts, can.restart_failed, can.send_failed, refused.can_frame.
class SocketCanLink final : public CanLink {
 public:
  /// Waits for an interface that is missing or down. Throws NoSocketCan with a one-line message for what waiting does
  /// not fix. `restart` returns the reason of a failure.
  using Restart = std::function<std::string(const std::string& interface)>;
  SocketCanLink(std::string interface, std::vector<std::uint32_t> ids, Restart restart = restart_can);

  void attach(EventLoop& loop, Handlers handlers) override;
  void send(const CanFrame& frame) override;
  void report(NodeReport& report) const override;

 private:
  void watch();
  void on_readable();
  void on_error_frame(std::uint32_t bits);
  void lose();
  void try_to_open();
  void try_to_restart();

  std::string interface_;
  std::vector<std::uint32_t> ids_;
  std::optional<CanSocket> socket_;
  EventLoop* loop_ = nullptr;
  Handlers handlers_;
  std::string why_;  // reason why there is no socket
  RetryBackoff retry_;
  Restart restart_;
  bool bus_off_ = false;
  std::int64_t restart_at_ = 0;     // us, steady clock
  std::int64_t restart_after_ = 0;  // us; 0: a frame was received since the latest bus-off
  std::string restart_failed_;
  Counters counters_;
};

}  // namespace curbstone::encoder::can
