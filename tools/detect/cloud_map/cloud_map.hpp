#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "services/semantic_map/cells/cell_classes.hpp"
#include "services/semantic_map/markings/marking_parameters.hpp"
#include "services/semantic_map/pipeline/tile_pipeline.hpp"
#include "services/semantic_map/tile/curb_parameters.hpp"
#include "services/semantic_map/tile/map_types.hpp"
#include "services/tensor_voting/voting/voting_parameters.hpp"

namespace curbstone::detect::cloud_map {

/// Options of the method on one cloud, without the stack around it: vote, ground, curbs, classes. The map's frame is
/// the cloud's; its z must point roughly up.
struct CloudMapOptions {
  tensor_voting::voting::VotingParameters voting;
  semantic_map::tile::CurbParameters curb;
  semantic_map::cells::ClassParameters classes;
  semantic_map::markings::MarkingParameters markings;
  std::vector<Eigen::Vector2d> path;  ///< driven path, m in the cloud's frame: stop lines lie across it
  double thin = 0.03;  ///< m, > 0: the first point in each cube of this edge is used, as a mapper would do
  double range = 80;   ///< m from the cloud's origin (0: all)
  int threads = 2;
};

/// A curb point in the cloud's frame.
struct CloudCurb {
  Eigen::Vector3d foot;
  double height = 0;
  Eigen::Vector2d up = Eigen::Vector2d::UnitX();  ///< towards the higher side
};

/// A point of the thinned cloud with its label.
struct DetectedPoint {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;
  float stick = 0, plate = 0, ball = 0;
  semantic_map::tile::CellClass label = semantic_map::tile::CellClass::kUnknown;
};

struct CloudMap {
  std::vector<semantic_map::tile::MapTile> tiles;  ///< by key
  std::vector<CloudCurb> curbs;
  std::vector<semantic_map::tile::CurbLine> lines;  ///< the curbs, linked; inferred ones last
  std::vector<semantic_map::tile::MarkingLine> markings;
  std::vector<DetectedPoint> points;
  std::size_t not_finite = 0;  ///< points skipped
  std::size_t out_of_range = 0;
};

/// The same without intensities, and so without markings.
[[nodiscard]] CloudMap map_cloud(std::span<const Eigen::Vector3f> points, const CloudMapOptions& options);

/// Computes the voted tiles of a cloud. It is the expensive part of map_cloud(), separate so that several parameters
/// can be tried on its result. `intensities`: of the points, as in VotedTile, or empty.
[[nodiscard]] std::vector<semantic_map::tile::VotedTile> vote_tiles(std::span<const Eigen::Vector3f> points,
                                                                    const CloudMapOptions& options, CloudMap& counts,
                                                                    std::span<const std::uint8_t> intensities = {});
/// The remaining part of map_cloud().
void map_tiles(const std::vector<semantic_map::tile::VotedTile>& tiles, const CloudMapOptions& options, CloudMap& map);

}  // namespace curbstone::detect::cloud_map
