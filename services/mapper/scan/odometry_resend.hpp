#pragma once

#include <cstdint>
#include <curbstone/odometry_t.hpp>
#include <string>

#include "common/bus/counters.hpp"
#include "common/resend/resend_client.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::scan {

/// Odometry that is missing from a history, for it was lost on the bus, is asked for, and a scan that needs it waits:
/// kPatience without any of it, or kShortPatience where interpolation makes up for it, as ResendClient counts it. Pure;
/// one thread.
///
/// Counters: odometry.resent (samples that came again), odometry.not_resent (gaps that were given up).
class OdometryResend {
 public:
  static constexpr std::int64_t kPatience = 1'000'000;     ///< us
  static constexpr std::int64_t kShortPatience = 300'000;  ///< us

  /// `history` must outlive this.
  OdometryResend(Publisher& bus, const std::string& requester, OdometryHistory& history)
      : client_(bus, requester, "ODOMETRY"), history_(history) {}

  /// A sample that was sent again, for whomever.
  void hear_again(const odometry_t& message);
  /// Each 20 ms: asks for what is missing. `now`, us, only paces.
  void tick(std::int64_t now);
  /// Whether this scan, the next to be processed, waits.
  [[nodiscard]] bool is_waited_for(const Scan& scan);

  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  ResendClient client_;
  OdometryHistory& history_;
  std::int64_t from_ = 0;      // us: gaps before this no longer matter
  std::int64_t gap_from_ = 0;  // us: where the gap that is waited for begins
  std::int64_t waited_ = 0;    // us, for it
  std::int64_t ticked_ = 0;    // us
  Counters counters_;
};

}  // namespace curbstone::mapper::scan
