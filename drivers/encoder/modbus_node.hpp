#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "common/bus/node.hpp"
#include "common/bus/refusal_share.hpp"
#include "common/shell/latency.hpp"
#include "drivers/encoder/encoder_config.hpp"
#include "drivers/encoder/modbus/drive_poll.hpp"
#include "drivers/encoder/stuck_counts.hpp"
#include "drivers/encoder/wheel_counter.hpp"
#include "drivers/encoder/wheels_output.hpp"
#include "drivers/link/link_state.hpp"

namespace curbstone::encoder {

[[nodiscard]] modbus::ModbusSettings modbus_settings(const EncoderConfig& config);

/// Converts readings of a two-wheel drive over Modbus, from any source, to WHEELS. It has no port and no clock. One
/// thread.
///
/// A reading's stamp is the middle between its request and its reply, which is accurate to half the round trip. After a
/// silence the counts restart: the drive may have lost power and count from 0. The motion in the meantime is lost, and
/// the first reading has no speed, so it is not published. Speeds and silences are measured by the steady clock: when
/// the host's clock is set, the stamps follow it and nothing else changes.
class ModbusNode final : public Node {
 public:
  ModbusNode(const EncoderConfig& config, Publisher& bus);

  void connect(Subscriber&) override {}
  /// `now`: us since the Unix epoch.
  void on_reading(std::int64_t now, const modbus::Reading& reading);
  /// `why`, if the link is down, is one line for the operator.
  void on_link(link::LinkState state, const std::string& why);
  void tick(std::int64_t now) override;
  void clock_was_set(std::int64_t by) override;
  [[nodiscard]] NodeReport report() const override;

  /// Called by report(), to add the counters and faults of the link.
  void add_report(std::function<void(NodeReport&)> add) { add_report_ = std::move(add); }

 private:
  void add_faults_of_drive(NodeReport& report) const;
  /// us, after which status and faults of the drive that were read say nothing of now.
  [[nodiscard]] std::int64_t old_status() const;

  EncoderConfig config_;
  WheelCounter odometer_;
  StuckCounts stuck_;
  WheelsOutput output_;
  modbus::Reading reading_;      // the latest one
  std::int64_t last_heard_ = 0;  // us, of its receipt, else of the node's start
  std::int64_t began_ = 0;
  std::int64_t now_ = 0;
  bool was_up_ = false;
  std::string link_fault_;
  RefusalShare share_;  // of readings; that of replies belongs to the link
  std::function<void(NodeReport&)> add_report_;
  LatencyWindow round_trips_;  // us
  Counters counters_;
};

}  // namespace curbstone::encoder
