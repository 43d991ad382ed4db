#pragma once

#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::mounting {

/// The points of a scan from which profiles are made: those too high to be ground, neither near the LiDAR nor far from
/// it. Profiles of one scan share them. A value, pure.
class UprightPoints {
 public:
  /// `points`: de-skewed, in base_link; `lidar`: its position there, m.
  UprightPoints(const std::vector<scan::LidarPoint>& points, const Eigen::Vector3d& lidar);

 private:
  friend class AzimuthProfile;
  Eigen::Vector3d lidar_;
  Eigen::ArrayXf x_, y_;  // m, in base_link: by columns, so that what is computed of them is computed side by side
  std::vector<std::uint8_t> ring_;
};

/// Horizontal range from the LiDAR to what stands beside the vehicle, for each laser and azimuth. Comparing two
/// profiles gives the turn between two scans directly: no map, no surfaces, and trunks and crowns of trees serve as
/// well as walls. A value, pure.
class AzimuthProfile {
 public:
  static constexpr int kBins = 720;
  static constexpr double kBin = 2 * std::numbers::pi / kBins;  ///< rad
  static constexpr int kMaxTurn = 48;                           ///< bins, largest turn that is searched for

  /// The profile is seen from the LiDAR's position in the frame that `T_there_base` leads to.
  AzimuthProfile(const UprightPoints& points, const Pose& T_there_base);
  AzimuthProfile(const std::vector<scan::LidarPoint>& points, const Pose& T_there_base, const Eigen::Vector3d& lidar)
      : AzimuthProfile(UprightPoints(points, lidar), T_there_base) {}

  /// Number of laser and azimuth pairs with a range.
  [[nodiscard]] std::size_t size() const { return seen_.size(); }
  /// Result of a comparison.
  struct Turn {
    double angle = 0;             ///< rad, to the left: turning this profile back by it gives the best agreement
    double residual = 0;          ///< 0 (the same) .. 1 (other surfaces), of the profiles at this angle
    double residual_at_zero = 0;  ///< the same without a turn
  };
  /// The turn of this profile against an earlier one from the same place. Nothing if either has too few ranges. No turn
  /// of more than a bin is searched for if the residual is near `usual`, that of scans which lately showed no turn.
  [[nodiscard]] std::optional<Turn> turn_since(const AzimuthProfile& earlier, double usual = 0) const;
  /// residual_at_zero alone.
  [[nodiscard]] std::optional<double> residual_to(const AzimuthProfile& earlier) const;

 private:
  [[nodiscard]] bool is_comparable(const AzimuthProfile& other) const;
  [[nodiscard]] double residual(const AzimuthProfile& earlier, int bins, std::size_t stride = 1) const;

  std::vector<float> ranges_;        // m, by laser and azimuth; 0: none
  std::vector<std::uint32_t> seen_;  // indices of those that are not 0
};

}  // namespace curbstone::mapper::mounting
