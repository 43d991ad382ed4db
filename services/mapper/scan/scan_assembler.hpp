#pragma once

#include <cstdint>
#include <curbstone/lidar_points_t.hpp>
#include <optional>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::scan {

/// Limits of a scan, and the valid range of returns.
struct AssemblyLimits {
  double min_range = 0.4;               ///< m, from the lidar
  double max_range = 120.0;             ///< m
  std::size_t max_points = 400'000;     ///< per scan; at 5 Hz 32 lasers with two returns send 230,000
  std::int64_t max_span = 400'000;      ///< us, per scan
  std::int64_t clock_jump = 1'000'000;  ///< us between packets, beyond which the clock has jumped
  std::int64_t set_back = 10'000;       ///< us back from one packet to the next, beyond which the clock was set back
};

/// Assembles the packets of a scan. Lost packets are counted. Late packets of the current scan are taken; late packets
/// of an older scan and duplicates are dropped. A clock jump or a driver restart begins a new scan. Pure; one thread.
///
/// Counters: lidar.one_stamp (scans whose points all have one stamp), lidar.packets, lidar.lost, lidar.reordered,
/// lidar.restarts, lidar.clock_jumps, dropped.late, dropped.duplicate, refused.packet, refused.not_finite,
/// points.out_of_range, refused.endless_scan.
class ScanAssembler {
 public:
  explicit ScanAssembler(const AssemblyLimits& limits = {}) : limits_(limits) {}

  /// Adds a packet. Returns the previous scan if this packet begins another one.
  [[nodiscard]] std::optional<Scan> add(const lidar_points_t& packet);
  /// Returns what there is of the current scan: the drive is over.
  [[nodiscard]] std::optional<Scan> flush();

  /// Whether all points of each of the last scans were taken in the same moment, by their stamps.
  [[nodiscard]] bool has_one_stamp() const { return with_one_stamp_ >= kTimeless; }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  static constexpr int kTimeless = 20;  // scans in a row
  void check_stamps(const Scan& done, std::int64_t next_start);
  void append(const lidar_points_t& packet);
  /// Takes a packet that later ones have overtaken.
  void take_late(const lidar_points_t& packet);
  [[nodiscard]] std::optional<Scan> restart_with(const lidar_points_t& packet);

  AssemblyLimits limits_;
  std::optional<Scan> current_;
  std::vector<std::int32_t> seen_;  // sequence numbers of the current scan's packets
  std::int64_t newest_utime_ = 0;
  std::int32_t newest_packet_ = 0;
  int with_one_stamp_ = 0;  // scans in a row
  Counters counters_;
};

}  // namespace curbstone::mapper::scan
