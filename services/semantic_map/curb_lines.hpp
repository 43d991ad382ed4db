#pragma once

#include <vector>

#include "services/semantic_map/curb_filter.hpp"
#include "services/semantic_map/map_types.hpp"

namespace curbstone {

/// A curb point in the map frame.
struct MapCurbPoint {
  Eigen::Vector2d foot = Eigen::Vector2d::Zero();  ///< m
  Eigen::Vector2d up = Eigen::Vector2d::UnitX();
  double z = 0;
  double height = 0;
  double confidence = 0;
  bool weak = false;
  double reach = 0;  ///< m along the curb, on each side, that the evidence is from
};

/// Links curb points to polylines along the curb, smoothed, at most one vertex each 0.15 m, gaps bridged up to 0.8 m
/// or as far as the evidence of the two ends reaches.
/// Ids count from 0 in the order of the points: the same points in the same order give the same lines.
[[nodiscard]] std::vector<CurbLine> link_curbs(const std::vector<MapCurbPoint>& points);

/// Gives lines the ids that the lines near them had before, and new ones new ids.
class CurbLineIds {
 public:
  void assign(std::vector<CurbLine>& lines);

 private:
  std::vector<CurbLine> before_;
  std::int32_t next_ = 0;
};

}  // namespace curbstone
