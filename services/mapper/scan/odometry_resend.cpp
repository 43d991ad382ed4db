#include "services/mapper/scan/odometry_resend.hpp"

#include <algorithm>

#include "services/mapper/scan/odometry_intake.hpp"

namespace curbstone::mapper::scan {
namespace {

constexpr std::int64_t kBeforeScan = 50'000;  // us of odometry before a scan that extrapolation may use

}  // namespace

void OdometryResend::add_resent(const odometry_t& message) {
  const std::optional<OdometrySample> sample = sample_of(message);
  if (!sample || !history_.fill(*sample)) return;
  client_.answered();
  counters_.add("odometry.resent");
}

void OdometryResend::tick(std::int64_t now) {
  waited_ += ResendClient::waited(now, ticked_);
  ticked_ = now;
  client_.ask(now, history_.gap(from_));
}

bool OdometryResend::must_wait(const Scan& scan) {
  from_ = std::max(from_, scan.start - kBeforeScan);
  if (from_ - scan.start > ResendClient::kMaxMissing) from_ = scan.start - kBeforeScan;  // the clock was set back
  while (const std::optional<MissingMessages> gap = history_.gap(from_)) {
    if (gap->after >= scan.end) return false;
    if (gap->after != gap_from_) {
      gap_from_ = gap->after;
      waited_ = 0;
    }
    const bool is_short = gap->before - gap->after <= OdometryHistory::kMaxGap;
    if (!client_.is_deaf(scan.end)) {
      if (waited_ <= (is_short ? kShortPatience : kPatience)) return true;
      client_.gave_up(scan.end);
      counters_.add("odometry.not_resent");
    }
    from_ = gap->before;
  }
  return false;
}

}  // namespace curbstone::mapper::scan
