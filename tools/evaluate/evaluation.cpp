#include "tools/evaluate/evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/evaluate/place_grid.hpp"

namespace curbstone::evaluate {

namespace {

constexpr double kFirm = 0.02;  // m, twice the error of one range, like the map's own margin

/// Calls visit(class, is_seen, centre in m in map) for every cell that the map knows. Interpolated road was not seen.
template <class Visit>
void for_each_known_cell(const std::vector<semantic_map::tile::MapTile>& tiles, Visit visit) {
  for (const semantic_map::tile::MapTile& tile : tiles) {
    for (int i = 0; i < semantic_map::tile::kCellsInTile; ++i) {
      const auto index = static_cast<std::size_t>(i);
      const semantic_map::tile::CellClass cell_class = tile.cell_class[index];
      const bool has_points = tile.height[index] != semantic_map::tile::MapTile::kNoHeight;
      if (cell_class == semantic_map::tile::CellClass::kUnknown && !has_points) continue;
      const double z = has_points ? kPositionStep * tile.height[index] : 0.0;
      const Eigen::Vector3d centre(tile.key.x * kTileSize + (i % kCellsPerTile + 0.5) * kCellSize,
                                   tile.key.y * kTileSize + (i / kCellsPerTile + 0.5) * kCellSize,
                                   static_cast<double>(tile.z_origin) + z);
      visit(cell_class, !tile.is_interpolated(index), centre);
    }
  }
}

std::vector<CurbFoot> feet_of(const semantic_map::tile::CurbLine& line, const Pose& T_truth_map) {
  std::vector<CurbFoot> feet;
  for (const semantic_map::tile::CurbVertex& vertex : line.points) {
    const Eigen::Vector3d at = T_truth_map * Eigen::Vector3f(vertex.x, vertex.y, vertex.z).cast<double>();
    const Eigen::Vector3d up =
        T_truth_map.linear() * Eigen::Vector3f(vertex.high_side_x, vertex.high_side_y, 0).cast<double>();
    feet.push_back({{at.x(), at.y()}, {up.x(), up.y()}});
  }
  return feet;
}

bool is_judged(Place place, const truth::Truth& truth) {
  return truth.classes.empty() || truth.classes.known_around(place.x, place.y);
}

/// Each foot represents half the distance to its neighbours.
void add_inferred(const std::vector<CurbFoot>& feet, const truth::Truth& truth,
                  std::vector<CurbMap::Inferred>& inferred) {
  const std::size_t first = inferred.size();
  for (const CurbFoot& foot : feet) inferred.push_back({foot.at, 0, is_judged(foot.at, truth)});
  for (std::size_t i = first + 1; i < inferred.size(); ++i) {
    const Place& a = inferred[i - 1].at;
    const Place& b = inferred[i].at;
    const double half = 0.5 * std::hypot(b.x - a.x, b.y - a.y);
    inferred[i - 1].length += half;
    inferred[i].length += half;
  }
}

bool is_blocking(semantic_map::tile::CellClass cell_class) {
  return cell_class == semantic_map::tile::CellClass::kObstacle || cell_class == semantic_map::tile::CellClass::kWall;
}

std::vector<Place> driven_path(const truth::PosePairs& pairs) {
  std::vector<Place> path;
  for (const Pose& pose : pairs.truth) {
    const Place place{pose.translation().x(), pose.translation().y()};
    if (path.empty() || std::hypot(place.x - path.back().x, place.y - path.back().y) > 0.2) path.push_back(place);
  }
  return path;
}

struct CellScores {
  Confusion all;
  Confusion firm;  // cells whose true class the fine truth is sure of
  BlockingScore blocking;
};

/// Scores the cells' classes, and adds cells that were seen to `map`.
CellScores score_cells(const std::vector<semantic_map::tile::MapTile>& tiles, const Pose& T_truth_map,
                       const truth::Truth& truth, const PlaceGrid<Place>& near_path, CurbMap& map) {
  CellScores scores;
  const auto count_in = [](Confusion& cells, std::uint8_t true_class, semantic_map::tile::CellClass cell_class) {
    if (true_class == 0 || true_class >= semantic_map::tile::kNumClasses) return;
    ++cells.count[true_class][static_cast<std::size_t>(cell_class)];
  };
  for_each_known_cell(
      tiles, [&](semantic_map::tile::CellClass cell_class, bool is_seen, const Eigen::Vector3d& centre) {
        const Eigen::Vector3d placed = T_truth_map * centre;
        const Place place{placed.x(), placed.y()};
        const std::uint8_t true_class = truth.class_of_cell(T_truth_map, centre, kCellSize);
        if (is_blocking(static_cast<semantic_map::tile::CellClass>(true_class)) && near_path.any_near(place.x, place.y))
          scores.blocking.count(cell_class, place);
        if (true_class == static_cast<std::uint8_t>(semantic_map::tile::CellClass::kRoad) && is_blocking(cell_class))
          scores.blocking.called_blocked.push_back(place);
        if (cell_class == semantic_map::tile::CellClass::kUnknown) return;
        if (is_seen) map.seen.push_back(place);
        if (cell_class == semantic_map::tile::CellClass::kCurb) map.cells.push_back({place, is_judged(place, truth)});
        count_in(scores.all, true_class, cell_class);
        if (!truth.fine_classes.empty())
          count_in(scores.firm, truth.class_of_cell(T_truth_map, centre, kCellSize, kFirm), cell_class);
      });
  return scores;
}

void add_lines(const std::vector<semantic_map::tile::CurbLine>& curbs, const Pose& T_truth_map,
               const truth::Truth& truth, CurbMap& map) {
  for (const semantic_map::tile::CurbLine& line : curbs) {
    const std::vector<CurbFoot> feet = feet_of(line, T_truth_map);
    if (line.inferred) {
      add_inferred(feet, truth, map.inferred);
      continue;
    }
    map.feet.insert(map.feet.end(), feet.begin(), feet.end());
    if (!line.dropped) continue;
    for (const CurbFoot& foot : feet) map.lowered.push_back(foot.at);
  }
}

}  // namespace

void BlockingScore::count(semantic_map::tile::CellClass cell_class, Place place) {
  if (is_blocking(cell_class)) {
    ++blocked;
  } else if (cell_class == semantic_map::tile::CellClass::kUnknown) {
    ++unknown;
  } else {
    called_free.push_back(place);
  }
}

std::int64_t Confusion::total() const {
  std::int64_t sum = 0;
  for (const auto& row : count) {
    for (const std::int64_t n : row) sum += n;
  }
  return sum;
}

double Confusion::accuracy() const {
  std::int64_t right = 0;
  for (std::size_t i = 0; i < count.size(); ++i) right += count[i][i];
  return total() > 0 ? static_cast<double>(right) / static_cast<double>(total()) : 0;
}

Evaluation evaluate(const std::vector<semantic_map::tile::MapTile>& tiles,
                    const std::vector<semantic_map::tile::CurbLine>& curbs, const truth::Trajectory& trajectory,
                    const truth::Truth& truth, double radius) {
  const truth::PosePairs pairs = truth::pair_up(truth.poses, trajectory);
  if (pairs.truth.size() < 2)
    throw std::runtime_error("the map's trajectory and the truth share no time: do they belong to one drive?");

  Evaluation evaluation;
  evaluation.trajectory = truth::trajectory_errors(pairs);
  evaluation.T_truth_map = truth::align(pairs);

  const std::vector<Place> path = driven_path(pairs);
  CurbMap map;
  const CellScores cells = score_cells(tiles, evaluation.T_truth_map, truth, PlaceGrid<Place>(path, radius), map);
  add_lines(curbs, evaluation.T_truth_map, truth, map);
  if (!truth.curbs.empty()) evaluation.curbs = score_curbs(map, truth.curbs, path, radius);
  if (!truth.classes.empty()) {
    evaluation.classes = cells.all;
    if (!truth.fine_classes.empty()) evaluation.firm_classes = cells.firm;
    evaluation.blocking = cells.blocking;
  }
  return evaluation;
}

}  // namespace curbstone::evaluate
