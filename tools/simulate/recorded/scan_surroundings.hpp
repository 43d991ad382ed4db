#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "tools/simulate/recorded/laser_scale.hpp"
#include "tools/simulate/recorded/recorded_motion.hpp"
#include "tools/simulate/recorded/scan_set.hpp"
#include "tools/simulate/sensors/surroundings.hpp"

namespace curbstone::simulate::recorded {

/// Simulates a LiDAR where other scans were recorded: each shot takes the recorded points just below and above it and
/// hits the surface between them. No return if none is near. No noise is added: the recording has its own.
class ScanSurroundings final : public sensors::Surroundings {
 public:
  /// `scale`: for the recorded intensities; null: they are used as recorded.
  ScanSurroundings(const ScanSet& scans, const RecordedMotion& motion, const Playback& playback,
                   const devices::LidarEmulator& lidar, std::shared_ptr<const LaserScale> scale = nullptr);

  void prepare(const sensors::PacketView& view) override;
  [[nodiscard]] devices::LidarShot measure(const sensors::Shot& shot) override;

 private:
  struct FixedPoint {
    float bearing;             ///< rad, counter-clockwise, in its scan's lidar frame
    Eigen::Vector3f position;  ///< m, in the lidar frame of the first scan, de-skewed
    std::uint8_t intensity;
  };
  struct LoadedScan {
    std::size_t index = 0;
    std::vector<FixedPoint> points;  ///< by bearing
  };
  /// A recorded point relative to the lens at present.
  struct Candidate {
    float azimuth;  ///< rad, clockwise
    float elevation;
    float reach;   ///< m from the lens, horizontally
    float height;  ///< m above the lens
    std::uint8_t intensity;
  };

  const LoadedScan& load(std::size_t index);
  [[nodiscard]] std::size_t scan_for(double recorded, double bearing) const;
  void add_points(const LoadedScan& scan, const sensors::PacketView& view, double from, double to);
  [[nodiscard]] devices::LidarShot meet(const Candidate* below, const Candidate* above, float elevation) const;

  const ScanSet& scans_;
  const RecordedMotion& motion_;
  Playback playback_;
  std::shared_ptr<const LaserScale> scale_;
  std::vector<double> elevations_;  ///< rad, by laser
  double lens_offset_ = 0;          ///< m, of the lens from the axis
  std::deque<LoadedScan> loaded_;
  std::vector<std::vector<Candidate>> columns_;
  double first_column_ = 0;  ///< rad, clockwise
  Eigen::Vector3d origin_;   ///< m, of the lidar when the points were transformed to its frame
};

}  // namespace curbstone::simulate::recorded
