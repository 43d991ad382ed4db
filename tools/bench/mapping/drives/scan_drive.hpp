#pragma once

#include <cmath>
#include <vector>

#include "tools/bench/mapping/drives/mapping_drive.hpp"
#include "tools/simulate/recorded/scan_set.hpp"

namespace curbstone::bench::mapping::drives {

/// A folder of scans in KITTI's layout. A sweep begins behind and turns clockwise (seen from above); a scan's stamp is
/// when it looks forward, and its pose is the one then. Scans that were put right for the motion already (unless given:
/// those without a folder of rings) count as taken at once. Base_link is the lidar.
class ScanDrive final : public MappingDrive {
 public:
  /// Which of the scans: some left out make the vehicle faster.
  struct Selection {
    std::size_t first = 0;
    std::size_t every = 1;
    std::size_t most = SIZE_MAX;
  };
  /// Throws std::runtime_error with one clear line.
  ScanDrive(const std::string& folder, const std::string& poses_file, const std::string& times_file,
            const Selection& selection);
  ScanDrive(const std::string& folder, const std::string& poses_file, const std::string& times_file)
      : ScanDrive(folder, poses_file, times_file, Selection{}) {}
  void set_swept(bool swept) { scans_.swept = swept; }
  /// How long the head takes for a scan. Unless given: as long as scans are apart, but at most 0.1 s, for where they
  /// are farther apart some were left out.
  void set_sweep(double seconds) { sweep_ = std::llround(seconds * 1e6); }

  void play(const Take& take) const override;
  [[nodiscard]] const evaluate::truth::Trajectory& truth() const override { return truth_; }
  /// From now on odometry is there, and as poor as this.
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
