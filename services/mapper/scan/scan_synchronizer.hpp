#pragma once

#include <cstdint>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/scan/lidar_clock.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/odometry_resend.hpp"
#include "services/mapper/scan/packet_intake.hpp"
#include "services/mapper/scan/scan.hpp"
#include "services/mapper/scan/scan_assembler.hpp"

namespace curbstone::mapper::scan {

/// How long a scan waits for odometry, s of LiDAR time.
struct SyncWaits {
  double first = 2.0;  ///< before the drive begins
  double next = 1.0;   ///< after a scan that had odometry; after one that had none, 0.25 s at most
};

/// Synchronises the two inputs: assembles LIDAR_POINTS into scans, and holds each scan until odometry has reached its
/// end, or until LiDAR time shows that odometry is missing. So the scans and the odometry known to each do not depend
/// on how the two channels interleave. Packets and odometry that were lost on the bus are requested and waited for, in
/// order. Pure; one thread.
///
/// Counters: those of PacketIntake, LidarClock, OdometryResend, ScanAssembler and take_odometry(); dropped.pending
/// (scans beyond kMaxPending), odometry.too_late (scans processed without odometry that came later).
class ScanSynchronizer {
 public:
  static constexpr std::size_t kMaxPending = 80;  ///< scans that wait for odometry: 4 s at 20 Hz

  ScanSynchronizer(Publisher& bus, const std::string& requester, const SyncWaits& waits)
      : waits_(waits), packets_(bus, requester, "LIDAR_POINTS"), odometry_resend_(bus, requester, odometry_) {}

  /// To be called before the first message: what another listener lacks since `utime`, us, is requested.
  void begin_at(std::int64_t utime);
  /// A new drive begins after the scan that ended at `utime`, us. Its first scan waits for odometry as at the start.
  void begin_drive(std::int64_t utime);

  void add(const lidar_points_t& packet);
  /// False if the message is not a valid pose at a valid time.
  bool add(const odometry_t& message);
  /// Messages that were sent again on request.
  void add_resent(const lidar_points_t& packet);
  void add_resent(const odometry_t& message) { odometry_resend_.add_resent(message); }
  /// Called every 20 ms: requests what is missing. `now`: us.
  void tick(std::int64_t now);
  /// The drive is over: no message follows.
  void flush();

  [[nodiscard]] bool empty() const { return pending_.empty(); }
  /// Whether the next scan waits no longer. `started`: the drive has begun. The queue must not be empty; this holds for
  /// the next two as well.
  [[nodiscard]] bool is_due(bool started);
  /// Whether odometry has reached the end of the next scan.
  [[nodiscard]] bool has_odometry() const { return odometry_.reaches(pending_.front().scan.end); }
  /// Removes the next scan. odometry() then answers as it was known when it first reached the scan's end.
  [[nodiscard]] Scan pop();

  [[nodiscard]] const OdometryHistory& odometry() const { return odometry_; }
  /// Odometry arrives, but its filter has not initialised by the end of this scan, and may still do so in time.
  [[nodiscard]] bool is_filter_starting(const Scan& scan) const;
  /// The scan has been processed: odometry long before its `start`, us, is dropped.
  void forget_before(std::int64_t start);
  /// The scan that ended at `end`, us, became part of the drive, with or without odometry.
  void note_processed(std::int64_t end, bool with_odometry);

  /// us, start of the first scan of the drive; 0: none yet.
  [[nodiscard]] std::int64_t first_start() const { return first_start_; }
  void add_packet_faults(std::vector<std::string>& faults) const;
  /// `has_map`: the drive has begun; `last_end`: us, of the last scan processed.
  void add_odometry_faults(std::vector<std::string>& faults, bool has_map, std::int64_t last_end) const;
  void add_counters(Counters& counters) const;

 private:
  struct Pending {
    Scan scan;
    std::int64_t since;  // us, LiDAR time when the scan was queued
  };
  /// us, newest stamp of the LiDAR.
  [[nodiscard]] std::int64_t lidar_time() const { return clock_.corrected(packets_.newest()); }
  void queue(std::optional<Scan> scan);
  void note_late_odometry();

  SyncWaits waits_;
  PacketIntake packets_;
  LidarClock clock_;
  ScanAssembler assembler_;
  OdometryHistory odometry_;
  OdometryResend odometry_resend_;
  const PacketIntake::Handler in_order_ = [this](const lidar_points_t& packet) {
    clock_.add(packet, odometry_.newest(), in_time_);
  };
  const LidarClock::Handler in_time_ = [this](const lidar_points_t& packet) { queue(assembler_.add(packet)); };
  std::deque<Pending> pending_;
  std::int64_t first_start_ = 0;     // us, start of the first scan
  std::int64_t first_queued_ = 0;    // us, LiDAR time when it was queued
  int without_odometry_ = 0;         // scans in a row
  std::deque<std::int64_t> missed_;  // us, ends of scans that were processed before odometry reached them
  std::int64_t too_late_ = 0;        // us, the newest of these whose odometry came later; 0: none
  Counters counters_;
};

}  // namespace curbstone::mapper::scan
