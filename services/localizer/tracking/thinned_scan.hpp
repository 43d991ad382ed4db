#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "services/mapper/scan/scan.hpp"

namespace curbstone::localizer::tracking {

/// What is registered of a revolution; in base_link.
struct ThinnedScan {
  std::vector<Eigen::Vector3d> points;   ///< means of small boxes
  std::vector<Eigen::Vector3d> paint{};  ///< returns that may be of paint
};

/// Thins revolutions to one point for each box of 0.12 m x 0.12 m x 0.25 m (height): the mean of its points, as in a
/// cell of the map. One thread; keeps its memory.
class ScanThinner {
 public:
  static constexpr double kReach = 30.0;  ///< m from base_link, in x and y

  ScanThinner();
  /// `points`: de-skewed, in base_link. Returns the means in the order in which their boxes were first hit.
  [[nodiscard]] std::vector<Eigen::Vector3d> thin(const std::vector<mapper::scan::LidarPoint>& points);

 private:
  struct Box {
    std::uint32_t place = 0;
    float count = 0;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  };
  std::vector<std::uint32_t> box_at_;  // index into boxes_, valid if that box is of this place
  std::vector<Box> boxes_;
};

}  // namespace curbstone::localizer::tracking
