#include "tools/evaluate/evaluation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tools/evaluate/place_grid.hpp"

namespace curbstone {

namespace {

/// Calls visit(class, place in the truth's frame) for every cell that is not unknown.
template <class Visit>
void for_each_known_cell(const std::vector<MapTile>& tiles, const Pose& T_truth_map, Visit visit) {
  for (const MapTile& tile : tiles) {
    for (int i = 0; i < kCellsInTile; ++i) {
      const auto index = static_cast<std::size_t>(i);
      const CellClass cell_class = tile.cell_class[index];
      if (cell_class == CellClass::kUnknown) continue;
      const double z = tile.height[index] == MapTile::kNoHeight ? 0.0 : kPositionStep * tile.height[index];
      const Eigen::Vector3d centre(tile.key.x * kTileSize + (i % kCellsPerTile + 0.5) * kCellSize,
                                   tile.key.y * kTileSize + (i / kCellsPerTile + 0.5) * kCellSize,
                                   static_cast<double>(tile.z_origin) + z);
      const Eigen::Vector3d placed = T_truth_map * centre;
      visit(cell_class, Place{placed.x(), placed.y()});
    }
  }
}

std::vector<Place> driven_path(const PosePairs& pairs) {
  std::vector<Place> path;
  for (const Pose& pose : pairs.truth) {
    const Place place{pose.translation().x(), pose.translation().y()};
    if (path.empty() || std::hypot(place.x - path.back().x, place.y - path.back().y) > 0.2) path.push_back(place);
  }
  return path;
}

}  // namespace

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

Evaluation evaluate(const std::vector<MapTile>& tiles, const std::vector<CurbLine>& curbs, const Trajectory& trajectory,
                    const Truth& truth, double radius) {
  const PosePairs pairs = pair_up(truth.poses, trajectory);
  if (pairs.truth.size() < 2)
    throw std::runtime_error("the map's trajectory and the truth share no time: do they belong to one drive?");

  Evaluation evaluation;
  evaluation.trajectory = trajectory_errors(pairs);
  evaluation.T_truth_map = align(pairs);

  CurbMap map;
  Confusion confusion;
  for_each_known_cell(tiles, evaluation.T_truth_map, [&](CellClass cell_class, Place place) {
    map.seen.push_back(place);
    if (cell_class == CellClass::kCurb) map.cells.push_back(place);
    const std::uint8_t true_class = truth.classes.at(place.x, place.y);
    if (true_class != 0 && true_class < kNumClasses)
      ++confusion.count[true_class][static_cast<std::size_t>(cell_class)];
  });
  for (const CurbLine& line : curbs) {
    for (const CurbVertex& vertex : line.points) {
      const Eigen::Vector3d placed =
          evaluation.T_truth_map * Eigen::Vector3f(vertex.x, vertex.y, vertex.z).cast<double>();
      map.feet.push_back({placed.x(), placed.y()});
    }
  }
  if (!truth.curbs.empty()) evaluation.curbs = score_curbs(map, truth.curbs, driven_path(pairs), radius);
  if (!truth.classes.empty()) evaluation.classes = confusion;
  return evaluation;
}

std::string to_table(const Evaluation& e) {
  std::string text;
  const auto line = [&](const std::string& s) { text += s + "\n"; };
  const TrajectoryErrors& t = e.trajectory;
  line(fmt::format("trajectory   {:.1f} m driven   ATE {:.3f} m   RPE {:.2f} %, {:.3f} deg/m   end {:.2f} %",
                   t.distance_m, t.ate_m, t.rpe_percent, t.rpe_deg_per_m, t.end_percent));
  if (e.curbs) {
    const CurbScore& c = *e.curbs;
    line("curbs        tolerance   precision   recall       F1");
    for (std::size_t i = 0; i < kTolerances.size(); ++i) {
      line(fmt::format("             {:6.2f} m   {:9.3f}   {:6.3f}   {:6.3f}", kTolerances[i], c.at[i].precision,
                       c.at[i].recall, c.at[i].f1()));
    }
    line(
        fmt::format("             {} curb cells, {} more at lowered kerbs (not counted); {} true points; recall of "
                    "what was seen {:.3f}",
                    c.detections, c.on_dropped, c.true_points, c.recall_of_seen));
    line(fmt::format("             lateral error of the foot: median {:.1f} cm, p95 {:.1f} cm", c.lateral_median_cm,
                     c.lateral_p95_cm));
  }
  if (e.classes) {
    static constexpr std::array kNames = {"unknown", "road", "curb", "obstacle", "wall"};
    line(fmt::format("classes      accuracy {:.3f} of {} seen cells; truth down, map across", e.classes->accuracy(),
                     e.classes->total()));
    std::string heading = fmt::format("             {:>10}", "");
    for (std::size_t column = 1; column < kNumClasses; ++column) heading += fmt::format("{:>10}", kNames[column]);
    line(heading);
    for (std::size_t row = 1; row < kNumClasses; ++row) {
      std::string cells = fmt::format("             {:>10}", kNames[row]);
      for (std::size_t column = 1; column < kNumClasses; ++column)
        cells += fmt::format("{:>10}", e.classes->count[row][column]);
      line(cells);
    }
  }
  if (e.run) {
    line(fmt::format("losses       {} packets, {} messages", e.run->lost_packets, e.run->lost_messages));
    for (const auto& [name, value] : e.run->losses) line(fmt::format("             {} {}", name, value));
    line(fmt::format("latency      measurement to tile: p50 {:.0f} ms, p95 {:.0f} ms ({} tiles)", e.run->latency_p50_ms,
                     e.run->latency_p95_ms, e.run->tiles));
    double sum = 0;
    std::string cores;
    for (const auto& [service, share] : e.run->cores) {
      cores += fmt::format("   {} {:.2f}", service, share);
      sum += share;
    }
    line(fmt::format("cores        {:.2f} in all:{}", sum, cores));
  }
  return text;
}

std::string to_json(const Evaluation& e) {
  nlohmann::json json;
  json["curb"] = nullptr;
  json["lateral_cm"] = nullptr;
  if (e.curbs) {
    for (std::size_t i = 0; i < kTolerances.size(); ++i) {
      const Score& score = e.curbs->at[i];
      json["curb"][fmt::format("{:.2f}", kTolerances[i])] = {
          {"precision", score.precision}, {"recall", score.recall}, {"f1", score.f1()}};
    }
    json["lateral_cm"] = {{"median", e.curbs->lateral_median_cm}, {"p95", e.curbs->lateral_p95_cm}};
  }
  json["classes"] = nullptr;
  if (e.classes) json["classes"] = {{"accuracy", e.classes->accuracy()}, {"confusion", e.classes->count}};
  json["trajectory"] = {{"distance_m", e.trajectory.distance_m},
                        {"ate_m", e.trajectory.ate_m},
                        {"rpe_percent", e.trajectory.rpe_percent},
                        {"rpe_deg_per_m", e.trajectory.rpe_deg_per_m},
                        {"end_percent", e.trajectory.end_percent}};
  json["dropped"] = nullptr;
  json["latency_ms"] = nullptr;
  json["cores"] = nullptr;
  if (e.run) {
    json["dropped"] = {{"packets", e.run->lost_packets}, {"messages", e.run->lost_messages}};
    json["latency_ms"] = {{"p50", e.run->latency_p50_ms}, {"p95", e.run->latency_p95_ms}};
    json["cores"] = e.run->cores;
  }
  return json.dump(2) + "\n";
}

}  // namespace curbstone
