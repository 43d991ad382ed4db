#pragma once

#include <cstdint>
#include <curbstone/odometry_t.hpp>
#include <string>

#include "common/bus/counters.hpp"
#include "common/resend/resend_client.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::scan {

/// Requests odometry that was lost on the bus, and holds back a scan that needs it. The scan waits kPatience without
/// any of the missing samples arriving, or kShortPatience where interpolation makes up for them, as ResendClient counts
/// it. Pure; one thread.
///
/// Counters: odometry.resent (samples that came again), odometry.not_resent (gaps that were given up).
class OdometryResend {
 public:
  static constexpr std::int64_t kPatience = 1'000'000;     ///< us
  static constexpr std::int64_t kShortPatience = 300'000;  ///< us

  /// `history` must outlive this.
  OdometryResend(Publisher& bus, const std::string& requester, OdometryHistory& history)
      : client_(bus, requester, "ODOMETRY"), history_(history) {}

  /// Takes a sample that was sent again, no matter who requested it.
  void add_resent(const odometry_t& message);
  /// Called every 20 ms: requests what is missing. `now`, us, only sets the pace of requests.
  void tick(std::int64_t now);
  /// Whether this scan, the next to be processed, must wait for odometry.
  [[nodiscard]] bool must_wait(const Scan& scan);

  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  ResendClient client_;
  OdometryHistory& history_;
  std::int64_t from_ = 0;      // us: gaps before this are irrelevant
  std::int64_t gap_from_ = 0;  // us: start of the gap that is waited for
  std::int64_t waited_ = 0;    // us, waited for this gap
  std::int64_t ticked_ = 0;    // us
  Counters counters_;
};

}  // namespace curbstone::mapper::scan
