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

/// How often the map says one class (column) where the truth is another (row); only cells that both know.
struct Confusion {
  std::array<std::array<std::int64_t, semantic_map::tile::kNumClasses>, semantic_map::tile::kNumClasses> count{};
  [[nodiscard]] std::int64_t total() const;
  [[nodiscard]] double accuracy() const;  ///< 0 when empty
};

/// What became of the cells that truly are obstacle or wall, within the radius of the path, and that points fell into.
struct BlockingScore {
  std::int64_t blocked = 0;        ///< the map says obstacle or wall
  std::int64_t unknown = 0;        ///< not free either: too few points, or only above the vehicle
  std::vector<Place> called_free;  ///< road or curb, m in truth: the misses that matter
  /// A cell that truly blocks, and what the map says of it.
  void count(semantic_map::tile::CellClass cell_class, Place place);
  [[nodiscard]] std::int64_t free() const { return static_cast<std::int64_t>(called_free.size()); }
  /// Of the cells that the map knows; 0 when there are none.
  [[nodiscard]] double recall() const {
    return blocked + free() > 0 ? static_cast<double>(blocked) / static_cast<double>(blocked + free()) : 0;
  }
};

struct Evaluation {
  truth::TrajectoryErrors trajectory;
  Pose T_truth_map = Pose::Identity();  ///< what laid the map onto the truth: the alignment of the trajectories
  std::optional<CurbScore> curbs;       ///< without true curbs: nothing
  std::optional<Confusion> classes;     ///< without a true class image: nothing
  /// Of these only cells that would be of the same class 2 cm wider and 2 cm narrower on each side: what is beyond
  /// dispute. Without fine true classes: nothing.
  std::optional<Confusion> firm_classes;
  std::optional<BlockingScore> blocking;  ///< as `classes`
  std::optional<RunFigures> run;          ///< without a recording: nothing
};

/// Compares a map with the truth. The map is laid on the truth by the rigid alignment of the two trajectories. Curbs
/// count within `radius` m of the driven path. Throws std::runtime_error when the trajectories share no time.
[[nodiscard]] Evaluation evaluate(const std::vector<semantic_map::tile::MapTile>& tiles,
                                  const std::vector<semantic_map::tile::CurbLine>& curbs,
                                  const truth::Trajectory& trajectory, const truth::Truth& truth, double radius);

}  // namespace curbstone::evaluate
