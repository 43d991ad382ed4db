#pragma once

#include <Eigen/Core>
#include <curbstone/marking_lines_t.hpp>
#include <vector>

#include "services/semantic_map/marking_lines/marking_lines.hpp"
#include "services/semantic_map/pipeline/tile_pipeline.hpp"
#include "services/semantic_map/tile/driven_path.hpp"

namespace curbstone::semantic_map {

/// Makes the MARKINGS message of the lines around the vehicle. A persisting line keeps its id from message to message.
class NearbyMarkings {
 public:
  /// `range`: m, half of the box's side; reduced if a message cannot hold all lines.
  NearbyMarkings(double range, const markings::MarkingParameters& parameters)
      : range_(range), parameters_(parameters) {}

  /// `curbs`: the curb lines about the vehicle; `vehicle`, `path`: m in map. The caller fills in utime and epoch.
  [[nodiscard]] marking_lines_t next(const pipeline::TilePipeline& pipeline, const std::vector<tile::CurbLine>& curbs,
                                     const Eigen::Vector2d& vehicle, const tile::DrivenPath& path);

 private:
  double range_;
  markings::MarkingParameters parameters_;
  marking_lines::MarkingLineIds ids_;
  std::int32_t revision_ = 0;
};

}  // namespace curbstone::semantic_map
