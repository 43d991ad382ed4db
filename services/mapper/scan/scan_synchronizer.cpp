#include "services/mapper/scan/scan_synchronizer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "common/time/microseconds.hpp"
#include "services/mapper/scan/odometry_intake.hpp"

namespace curbstone::mapper::scan {
namespace {

constexpr double kNextWait = 0.25;                     // s, after a wait without result
constexpr std::int64_t kOdometryBefore = 100'000;      // us before the first scan
constexpr std::int64_t kKeptOdometry = 100'000;        // us before the newest scan
constexpr int kOdometryMissing = 5;                    // scans in a row; the last scans of a drive always lack it
constexpr std::int64_t kLateReportedFor = 60'000'000;  // us of the drive

}  // namespace

void ScanSynchronizer::begin_at(std::int64_t utime) {
  packets_.begin_at(utime);
  odometry_.begin_at(utime - kOdometryBefore);
}

void ScanSynchronizer::begin_drive(std::int64_t utime) {
  first_start_ = utime;
  if (without_odometry_ == 0) first_queued_ = lidar_time();  // else no wait for odometry
}

void ScanSynchronizer::add(const lidar_points_t& packet) {
  packets_.add(packet, in_order_);
}

void ScanSynchronizer::add_resent(const lidar_points_t& packet) {
  packets_.add_resent(packet, in_order_);
}

bool ScanSynchronizer::add(const odometry_t& message) {
  if (!take_odometry(message, odometry_, counters_)) return false;
  note_late_odometry();
  return true;
}

void ScanSynchronizer::tick(std::int64_t now) {
  packets_.tick(now, in_order_);
  odometry_resend_.tick(now);
}

void ScanSynchronizer::flush() {
  packets_.release(in_order_);
  clock_.release(in_time_);
  queue(assembler_.flush());
}

void ScanSynchronizer::queue(std::optional<Scan> scan) {
  if (!scan) return;
  if (first_start_ == 0) {
    first_start_ = scan->start;
    first_queued_ = lidar_time();
  }
  if (pending_.size() >= kMaxPending) {
    counters_.add("dropped.pending");
    pending_.pop_front();
  }
  pending_.push_back({std::move(*scan), lidar_time()});
}

/// Notes scans processed without odometry whose odometry arrives now: in a replay odometry is never late, so its map
/// differs.
void ScanSynchronizer::note_late_odometry() {
  for (; !missed_.empty() && odometry_.reaches(missed_.front()); missed_.pop_front()) {
    if (!odometry_.covers(missed_.front(), missed_.front())) continue;
    counters_.add("odometry.too_late");
    too_late_ = missed_.front();
  }
}

bool ScanSynchronizer::is_due(bool started) {
  const Pending& next = pending_.front();
  if (odometry_.reaches(next.scan.end)) return !odometry_resend_.must_wait(next.scan);
  const std::int64_t waited_since = started ? next.since : first_queued_;
  // After a wait without result the filter is probably gone rather than late: later scans wait less.
  const double wait = !started ? waits_.first : without_odometry_ == 0 ? waits_.next : std::min(waits_.next, kNextWait);
  return std::abs(lidar_time() - waited_since) > microseconds(wait);
}

Scan ScanSynchronizer::pop() {
  Scan scan = std::move(pending_.front().scan);
  pending_.pop_front();
  odometry_.set_horizon(scan.end);
  return scan;
}

bool ScanSynchronizer::is_filter_starting(const Scan& scan) const {
  return odometry_.reaches(scan.end) && !odometry_.covers(scan.start, scan.end) &&
         scan.end - first_start_ <= microseconds(waits_.first);
}

void ScanSynchronizer::forget_before(std::int64_t start) {
  odometry_.forget_before(start - kKeptOdometry);
}

void ScanSynchronizer::note_processed(std::int64_t end, bool with_odometry) {
  if (!odometry_.reaches(end) && missed_.size() < kMaxPending) missed_.push_back(end);
  without_odometry_ = with_odometry ? 0 : without_odometry_ + 1;
}

void ScanSynchronizer::add_packet_faults(std::vector<std::string>& faults) const {
  packets_.add_faults(faults);
  clock_.add_faults(faults);
  if (assembler_.has_one_stamp())
    faults.emplace_back(
        "LiDAR: all points of a revolution have one stamp, so the map is bent where the vehicle moves: its driver must "
        "stamp each packet, or each point");
}

void ScanSynchronizer::add_odometry_faults(std::vector<std::string>& faults, bool has_map,
                                           std::int64_t last_end) const {
  add_second_filter_fault(odometry_, faults);
  if (has_map && without_odometry_ >= kOdometryMissing)
    faults.emplace_back("no usable ODOMETRY: assuming constant velocity");
  if (too_late_ != 0 && last_end - too_late_ < kLateReportedFor)
    faults.push_back(fmt::format("{} revolutions went without odometry that came too late: a replay makes another map",
                                 counters_["odometry.too_late"]));
}

void ScanSynchronizer::add_counters(Counters& counters) const {
  for (const Counters* part :
       {&counters_, &packets_.counters(), &clock_.counters(), &odometry_resend_.counters(), &assembler_.counters()})
    counters.add(*part);
}

}  // namespace curbstone::mapper::scan
