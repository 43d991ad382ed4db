#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/semantic_map/tile/map_types.hpp"
#include "tools/evaluate/curb_score.hpp"
#include "tools/evaluate/run_log.hpp"
#include "tools/evaluate/truth/trajectory.hpp"
#include "tools/evaluate/truth/truth.hpp"

namespace curbstone::evaluate {

/// Confusion matrix: counts by the truth's class (row) and the map's class (column), over cells known to both.
struct Confusion {
  std::array<std::array<std::int64_t, semantic_map::tile::kNumClasses>, semantic_map::tile::kNumClasses> count{};
  [[nodiscard]] std::int64_t total() const;
  [[nodiscard]] double accuracy() const;  ///< 0 when empty
};

/// The map's result for cells that are truly obstacle or wall, within the radius of the path, and that were hit by
/// points.
struct BlockingScore {
  std::int64_t blocked = 0;           ///< obstacle or wall in the map
  std::int64_t unknown = 0;           ///< unknown, so not free either: too few points, or only above the vehicle
  std::vector<Place> called_free;     ///< road or curb in the map, m in truth: the dangerous misses
  std::vector<Place> called_blocked;  ///< truly road, but obstacle or wall in the map, m in truth, near or far
  /// Counts a cell that is truly blocked, with its class in the map.
  void count(semantic_map::tile::CellClass cell_class, Place place);
  [[nodiscard]] std::int64_t free() const { return static_cast<std::int64_t>(called_free.size()); }
  /// Over the cells known to the map; 0 if there are none.
  [[nodiscard]] double recall() const {
    return blocked + free() > 0 ? static_cast<double>(blocked) / static_cast<double>(blocked + free()) : 0;
  }
};

struct Evaluation {
  truth::TrajectoryErrors trajectory;
  Pose T_truth_map = Pose::Identity();  ///< from the alignment of the trajectories
  std::optional<CurbScore> curbs;       ///< empty without true curbs
  std::optional<Confusion> classes;     ///< empty without a true class image
  /// The same over only those cells whose true class would be the same if they were 2 cm wider or 2 cm narrower on each
  /// side, which makes it certain. Empty without fine true classes.
  std::optional<Confusion> firm_classes;
  std::optional<BlockingScore> blocking;  ///< empty like `classes`
  std::optional<RunFigures> run;          ///< empty without a recording
};

/// Compares a map with the truth. The map is aligned with the truth by the rigid alignment of the two trajectories.
/// Curbs count within `radius` m of the driven path. Throws std::runtime_error if the trajectories have no time in
/// common.
[[nodiscard]] Evaluation evaluate(const std::vector<semantic_map::tile::MapTile>& tiles,
                                  const std::vector<semantic_map::tile::CurbLine>& curbs,
                                  const truth::Trajectory& trajectory, const truth::Truth& truth, double radius);

}  // namespace curbstone::evaluate
