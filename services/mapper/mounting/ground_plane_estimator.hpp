#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::mounting {

/// The ground plane in base_link, where it should be z = 0: z = height + along x + across y.
struct GroundPlane {
  double height = 0;  ///< m, at the origin
  double along = 0;   ///< rise per metre forward
  double across = 0;  ///< rise per metre to the left
};

/// Estimates the ground plane around the vehicle: the median height in each cell of the strip that the vehicle drives
/// in, ahead and behind. Other vehicles, kerbs, crests and dips pass; a mounting error of the LiDAR persists. The
/// caller leaves out revolutions during which the vehicle stands, brakes or leans in a bend.
///
/// Keeps kMinRevolutions to about 2 kMinRevolutions revolutions. A function of the calls to add(). Pure; one thread.
class GroundPlaneEstimator {
 public:
  static constexpr int kMinRevolutions = 60;  ///< revolutions before there is a result

  GroundPlaneEstimator() : cells_(kColumns * kRows) {}
  /// `points`: a revolution, in base_link.
  void add(const std::vector<scan::LidarPoint>& points);
  /// None before kMinRevolutions revolutions, or if too little ground was visible.
  [[nodiscard]] std::optional<GroundPlane> plane() const;

 private:
  static constexpr int kColumns = 24;  // of 1 m, along x
  static constexpr int kRows = 8;      // of 0.5 m
  static constexpr int kBins = 150;    // of 2 cm
  struct Cell {
    std::array<std::uint16_t, kBins> heights{};
    int count = 0;
    [[nodiscard]] double median() const;
    void halve();
  };
  std::vector<Cell> cells_;
  int num_revolutions_ = 0;
};

}  // namespace curbstone::mapper::mounting
