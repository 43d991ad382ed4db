#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/semantic_map/curbs/curb_face.hpp"
#include "services/semantic_map/curbs/step_search.hpp"
#include "services/semantic_map/ground/ground_model.hpp"
#include "services/semantic_map/tile/curb_parameters.hpp"
#include "services/semantic_map/tile/voted_tile.hpp"

namespace curbstone::semantic_map::curbs {

/// A place that looks like a curb by itself, before its neighbours are asked.
struct CurbCandidate {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();   ///< m from the tile's corner, may lie a little outside: mid-face
  Eigen::Vector2d up = Eigen::Vector2d::UnitX();  ///< unit vector across, towards the higher side
  double z = 0;                                   ///< m in map, of the low side at the foot
  double height = 0;                              ///< m, of the step
  FaceLean lean;                                  ///< of what is seen of it
  double reach = 0;                               ///< m along the curb, on each side, that the evidence is from
  double score = 0;                               ///< the step in units of its noise
  bool falls = false;  ///< as HeightStep says; unless weak it is no curb, but what is there instead
  bool weak = false;   ///< only counts where a line of others goes on
  bool operator==(const CurbCandidate&) const = default;
};

/// The candidates of a tile, and what it took to find them.
struct CurbEvidence {
  std::vector<CurbCandidate> candidates;
  SearchEffort effort;
};

/// Section VI, curb evidence: where normals near the ground tilt more than flat ground's do, and the ground really
/// steps up from one side to the other. A cell may give several candidates, in different directions. Of the centre
/// tile; looks at points up to 1.2 m around it: 0.60 m across a step, 1.0 m along it. Pure, but for memory that each
/// thread keeps for its next call.
[[nodiscard]] CurbEvidence find_curb_evidence(const tile::Around<tile::VotedTile>& tiles,
                                              const ground::GroundSurface& ground,
                                              const tile::CurbParameters& parameters);

}  // namespace curbstone::semantic_map::curbs
