#pragma once

#include <cmath>
#include <vector>

#include "tools/bench/mapping/drives/mapping_drive.hpp"
#include "tools/simulate/recorded/scan_set.hpp"

namespace curbstone::bench::mapping::drives {

/// A folder of scans in KITTI's layout. A sweep begins behind and turns clockwise (seen from above); a scan's stamp and
/// pose are those of the moment it looks forward. Scans that were de-skewed already (by default those without a folder
/// of rings) count as instantaneous. Base_link is the lidar.
class ScanDrive final : public MappingDrive {
 public:
  /// The scans used; leaving some out makes the vehicle faster.
  struct Selection {
    std::size_t first = 0;
    std::size_t every = 1;
    std::size_t most = SIZE_MAX;
  };
  /// Throws std::runtime_error with a one-line message.
  ScanDrive(const std::string& folder, const std::string& poses_file, const std::string& times_file,
            const Selection& selection);
  ScanDrive(const std::string& folder, const std::string& poses_file, const std::string& times_file)
      : ScanDrive(folder, poses_file, times_file, Selection{}) {}
  void set_swept(bool swept) { scans_.swept = swept; }
  /// Duration of a sweep. Default: the interval between scans, but at most 0.1 s, because larger intervals mean that
  /// scans were left out.
  void set_sweep(double seconds) { sweep_ = std::llround(seconds * 1e6); }

  void play(const Take& take) const override;
  [[nodiscard]] const evaluate::truth::Trajectory& truth() const override { return truth_; }
  /// Adds odometry of these samples.
  void add_odometry(const std::vector<mapper::scan::OdometrySample>& samples);
  [[nodiscard]] std::int64_t period() const { return period_; }  ///< us
  [[nodiscard]] mapper::scan::Scan scan(std::size_t scan) const;

 private:
  simulate::recorded::ScanSet scans_;
  evaluate::truth::Trajectory truth_;
  std::int64_t period_;
  std::int64_t sweep_;  // us
  std::vector<mapper::scan::OdometrySample> odometry_;
};

}  // namespace curbstone::bench::mapping::drives
