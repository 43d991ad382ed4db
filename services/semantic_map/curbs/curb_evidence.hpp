#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/semantic_map/curbs/curb_face.hpp"
#include "services/semantic_map/curbs/step_search.hpp"
#include "services/semantic_map/ground/ground_model.hpp"
#include "services/semantic_map/tile/curb_parameters.hpp"
#include "services/semantic_map/tile/voted_tile.hpp"

namespace curbstone::semantic_map::curbs {

/// A place that looks like a curb by itself; its neighbours have not been considered yet.
struct CurbCandidate {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();   ///< m from the tile's corner, middle of the face; may lie outside
  Eigen::Vector2d up = Eigen::Vector2d::UnitX();  ///< unit vector across, towards the higher side
  double z = 0;                                   ///< m in map, of the low side at the foot
  double height = 0;                              ///< m, of the step
  FaceLean lean;                                  ///< of the part of the face that was seen
  double reach = 0;                               ///< m along the curb, on each side, from which the evidence comes
  double score = 0;                               ///< height in units of its noise
  bool falls = false;  ///< HeightStep::falls(): unless it is weak it only suppresses others, and is no curb itself
  bool weak = false;   ///< counts only where a line of others continues over it
  bool operator==(const CurbCandidate&) const = default;
};

/// The candidates of a tile, and the work of finding them.
struct CurbEvidence {
  std::vector<CurbCandidate> candidates;
  SearchEffort effort;
};

/// Section VI, curb evidence: the places of the centre tile where normals near the ground tilt more than those of flat
/// ground, and where the ground steps up from one side to the other. A cell may give several candidates, in different
/// directions. Uses points up to 1.2 m around the tile: a window reaches 0.60 m across a step and 1.0 m along it. Pure,
/// except for scratch memory that each thread keeps for its next call.
[[nodiscard]] CurbEvidence find_curb_evidence(const tile::Around<tile::VotedTile>& tiles,
                                              const ground::GroundSurface& ground,
                                              const tile::CurbParameters& parameters);

}  // namespace curbstone::semantic_map::curbs
