#pragma once

#include <Eigen/Core>
#include <curbstone/curb_lines_t.hpp>
#include <vector>

#include "services/semantic_map/curb_lines/curb_lines.hpp"
#include "services/semantic_map/pipeline/tile_pipeline.hpp"
#include "services/semantic_map/tile/driven_path.hpp"

namespace curbstone::semantic_map {

/// Makes the CURBS message of the lines around the vehicle. A persisting line keeps its id from message to message.
class NearbyCurbs {
 public:
  /// `range`: m, half of the box's side; reduced if a message cannot hold all lines.
  explicit NearbyCurbs(double range) : range_(range) {}

  /// `vehicle`, `path`: m in map; the path determines the sign of a line's rise. The caller fills in utime and epoch.
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
