#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "common/bus/counters.hpp"
#include "drivers/encoder/canopen/canopen.hpp"

namespace curbstone::encoder::canopen {

/// Reads and writes a node's object dictionary, one expedited transfer at a time (CiA 301, 7.2.4). A reply counts only
/// if it names the requested object. Without a reply the transfer is aborted and retried. Pure: time (us) is an
/// argument, frames go to `send`.
///
/// Counts: sdo.requests, sdo.retries, sdo.timeouts, sdo.aborts, ignored.sdo (replies to another master, or too late).
class SdoClient {
 public:
  using Send = std::function<void(const can::CanFrame&)>;
  struct Result {
    enum class Status { kOk, kAborted, kNoAnswer } status = Status::kOk;
    std::uint32_t value = 0;  ///< the value read, or the abort code
  };
  using Done = std::function<void(std::int64_t now, const Result&)>;

  static constexpr std::int64_t kAnswerTime = 100'000;  ///< us
  static constexpr int kMaxTries = 5;

  SdoClient(std::uint8_t node, Send send) : node_(node), send_(std::move(send)) {}

  [[nodiscard]] bool busy() const { return pending_.has_value(); }
  /// Do not call it while busy(). `done` is called once, and may begin the next transfer.
  void read(std::int64_t now, canopen::Object object, Done done);
  /// `size`: 1, 2 or 4 bytes.
  void write(std::int64_t now, canopen::Object object, std::uint8_t size, std::uint32_t value, Done done);
  /// Drops the transfer in progress, after a restart of the node.
  void cancel() { pending_.reset(); }

  /// Takes a frame of the node's SDO server.
  void on_frame(std::int64_t now, const can::CanFrame& frame);
  void tick(std::int64_t now);
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Pending {
    canopen::Object object;
    can::CanFrame request;
    Done done;
    std::int64_t sent = 0;
    int tries = 0;
  };

  void begin(std::int64_t now, canopen::Object object, canopen::SdoCommand command, std::uint32_t value, Done done);
  void send_request(std::int64_t now);
  void finish(std::int64_t now, const Result& result);

  std::uint8_t node_;
  Send send_;
  std::optional<Pending> pending_;
  Counters counters_;
};

}  // namespace curbstone::encoder::canopen
