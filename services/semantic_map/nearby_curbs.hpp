#pragma once

#include <Eigen/Core>
#include <curbstone/curb_lines_t.hpp>
#include <vector>

#include "services/semantic_map/curb_lines/curb_lines.hpp"
#include "services/semantic_map/pipeline/tile_pipeline.hpp"
#include "services/semantic_map/tile/driven_path.hpp"

namespace curbstone::semantic_map {

/// What CURBS says of the lines about the vehicle. A line that is still there keeps its id from message to message.
class NearbyCurbs {
 public:
  /// `range`: m, half of the box's side; less where there is more than a message holds.
  explicit NearbyCurbs(double range) : range_(range) {}

  /// `vehicle`, `path`: m in map; the path decides which way a line rises. The caller fills in utime and epoch.
  [[nodiscard]] curb_lines_t next(const pipeline::TilePipeline& pipeline, const Eigen::Vector2d& vehicle,
                                  const tile::DrivenPath& path);
  /// The lines of the last message.
  [[nodiscard]] const std::vector<tile::CurbLine>& lines() const { return lines_; }

 private:
  double range_;
  curb_lines::CurbLineIds ids_;
  std::vector<tile::CurbLine> lines_;
  std::int32_t revision_ = 0;
};

}  // namespace curbstone::semantic_map
