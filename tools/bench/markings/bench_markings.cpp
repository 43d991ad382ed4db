#include "tools/bench/markings/bench_markings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "common/config/command_line.hpp"
#include "tools/bench/curbs/scenes/town_drive.hpp"
#include "tools/bench/markings/marking_picture.hpp"
#include "tools/bench/markings/marking_tables.hpp"
#include "tools/bench/markings/painted_street.hpp"
#include "tools/bench/markings/painted_town.hpp"
#include "tools/detect/cloud_map/cloud_map.hpp"
#include "tools/output/text_file.hpp"

namespace curbstone::bench::markings {
namespace {

using semantic_map::markings::MarkingParameters;
using semantic_map::tile::VotedTile;

struct Arguments {
  std::vector<std::string> parts = {"street", "driven", "town"};
  std::vector<std::string> paints = {"fresh", "worn", "none"};
  std::string data = "../shared/data/kitti00";
  std::string json;
  std::string pictures;
  int seeds = 2;
  int first_seed = 1;
  int seconds = 60;
  bool ablation = false;
  bool no_gains = false;
  std::vector<std::string> assignments;
  detect::cloud_map::CloudMapOptions options;

  [[nodiscard]] bool wants(const std::string& part) const {
    return std::find(parts.begin(), parts.end(), part) != parts.end();
  }
};

/// The parameters for --set.
struct MarkingBenchConfig {
  MarkingParameters markings;
  void visit(ConfigVisitor& v) { v.section("markings", markings, "how the paint on the road is found"); }
};

struct MarkingMethod {
  std::string name;
  MarkingParameters parameters;
};

std::vector<MarkingMethod> methods(const MarkingParameters& parameters, bool ablation) {
  std::vector<MarkingMethod> ways = {{"local, two-sided, vote", parameters}};
  if (!ablation) return ways;
  ways.push_back({"one-sided", parameters});
  ways.back().parameters.two_sided = false;
  ways.push_back({"without the vote", parameters});
  ways.back().parameters.vote = false;
  ways.push_back({"one level everywhere", parameters});
  ways.back().parameters.local = false;
  return ways;
}

detect::cloud_map::CloudMap map_of(const std::vector<VotedTile>& tiles, const Arguments& arguments,
                                   const MarkingParameters& parameters) {
  detect::cloud_map::CloudMapOptions options = arguments.options;
  options.markings = parameters;
  detect::cloud_map::CloudMap map;
  detect::cloud_map::map_tiles(tiles, options, map);
  return map;
}

/// Adds the cells of streets of the same name.
void add_score(std::vector<StreetFigures>& figures, const std::string& street, const std::string& method,
               const CellScore& score) {
  const auto it = std::find_if(figures.begin(), figures.end(),
                               [&](const StreetFigures& f) { return f.cloud == street && f.method == method; });
  if (it == figures.end())
    figures.push_back({street, method, score});
  else
    it->score.add(score);
}

std::vector<StreetFigures> bench_street(const Arguments& arguments) {
  std::vector<StreetFigures> figures;
  const PaintTruth truth = read_street_paint(arguments.data);
  int number = 0;
  for (const PaintedStreet& street : read_painted_streets(arguments.data)) {
    ++number;
    for (const bool by_ring : {true, false}) {
      if (!by_ring && !arguments.ablation) continue;
      detect::cloud_map::CloudMap counts;
      const auto tiles = detect::cloud_map::vote_tiles(street.points, arguments.options, counts,
                                                       by_ring ? street.by_ring : street.raw);
      for (const MarkingMethod& way : methods(arguments.options.markings, arguments.ablation)) {
        const auto lines = map_of(tiles, arguments, way.parameters).markings;
        const std::string name = (by_ring ? "ring, " : "raw, ") + way.name;
        add_score(figures, street.name, name, score_cells(cells_of(lines, Pose::Identity()), truth));
        if (!arguments.pictures.empty())
          draw_markings(tiles, truth.painted, lines,
                        fmt::format("{}/{}_{}_{}.png", arguments.pictures, street.name, number, name));
      }
    }
  }
  return figures;
}

detect::cloud_map::CloudMap map_of(const curbs::scenes::DriveTiles& made, Arguments arguments,
                                   const MarkingParameters& parameters) {
  for (const auto& pose : made.trajectory) arguments.options.path.emplace_back(pose.pose.translation().head<2>());
  return map_of(made.tiles, arguments, parameters);
}

Pose align(const evaluate::truth::Trajectory& truth, const curbs::scenes::DriveTiles& made) {
  return evaluate::truth::align(evaluate::truth::pair_up(truth, made.trajectory));
}

/// The street as measured by the emulated RS16 of a vehicle.
std::vector<StreetFigures> bench_driven(const Arguments& arguments) {
  std::vector<StreetFigures> figures;
  const PaintTruth truth = read_street_paint(arguments.data);
  for (int seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
    const auto drive = curbs::scenes::drive_recorded(arguments.data, static_cast<std::uint64_t>(seed));
    const Pose T_first_map = drive.T_world_first.inverse() * align(drive.truth.poses, drive.made);
    for (const MarkingMethod& way : methods(arguments.options.markings, arguments.ablation)) {
      const auto lines = map_of(drive.made, arguments, way.parameters).markings;
      add_score(figures, "RS16, driven", way.name, score_cells(cells_of(lines, T_first_map), truth));
    }
  }
  return figures;
}

/// Places that are ground in a map, at most 8 m from the driven path.
class JudgedPlaces {
 public:
  JudgedPlaces(const detect::cloud_map::CloudMap& map, const evaluate::truth::Trajectory& path, const Pose& T_map_truth)
      : T_map_truth_(T_map_truth), path_(path) {
    for (const auto& tile : map.tiles) {
      for (int i = 0; i < semantic_map::tile::kCellsInTile; ++i) {
        if (tile.cell_class[static_cast<std::size_t>(i)] == semantic_map::tile::CellClass::kRoad)
          ground_.insert(
              {tile.key.x * kCellsPerTile + i % kCellsPerTile, tile.key.y * kCellsPerTile + i / kCellsPerTile});
      }
    }
    for (const auto& pose : path) {
      const Eigen::Vector2d at = pose.pose.translation().head<2>();
      const TileKey centre = square(at);
      for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) near_[{centre.x + x, centre.y + y}].push_back(at);
      }
    }
  }
  [[nodiscard]] bool operator()(const Eigen::Vector2d& at) const {
    const auto it = near_.find(square(at));
    if (it == near_.end()) return false;
    const bool is_near = std::any_of(it->second.begin(), it->second.end(),
                                     [&](const Eigen::Vector2d& p) { return (p - at).norm() <= kRadius; });
    return is_near && ground_.contains(cell_of((T_map_truth_ * Eigen::Vector3d(at.x(), at.y(), 0)).head<2>()));
  }

 private:
  static constexpr double kRadius = 8.0;  // m
  static TileKey square(const Eigen::Vector2d& at) {
    return {static_cast<std::int32_t>(std::floor(at.x() / kRadius)),
            static_cast<std::int32_t>(std::floor(at.y() / kRadius))};
  }
  Pose T_map_truth_;
  const evaluate::truth::Trajectory& path_;
  PaintCells ground_;
  std::unordered_map<TileKey, std::vector<Eigen::Vector2d>, TileKeyHash> near_;
};

double length_of(const evaluate::truth::Trajectory& path) {
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i)
    length += (path[i].pose.translation() - path[i - 1].pose.translation()).norm();
  return length;
}

PaintCells cells_of_truth(const std::vector<TrueLine>& truth, const Pose& T_map_truth) {
  std::vector<semantic_map::tile::MarkingLine> lines;
  for (const TrueLine& line : truth) {
    for (const TruePiece& piece : line.pieces) {
      auto& as_found = lines.emplace_back();
      as_found.width = static_cast<float>(piece.width);
      for (const Eigen::Vector2d& p : piece.centre)
        as_found.points.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), 0, true});
    }
  }
  return cells_of(lines, T_map_truth);
}

void bench_town(const Arguments& arguments, const std::string& paint_name, simulate::paint::Paint paint,
                std::vector<TownFigures>& figures) {
  const std::vector<MarkingMethod> ways = methods(arguments.options.markings, arguments.ablation);
  const std::size_t first = figures.size();
  for (const MarkingMethod& way : ways)
    figures.push_back({paint_name + (arguments.no_gains ? ", one scale" : ""), way.name, {}});
  for (int seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
    const PaintedTown town =
        drive_painted_town(static_cast<std::uint64_t>(seed), arguments.seconds, paint, !arguments.no_gains);
    const Pose T_truth_map = align(town.poses, town.made);
    for (std::size_t k = 0; k < ways.size(); ++k) {
      const auto map = map_of(town.made, arguments, ways[k].parameters);
      const JudgedPlaces judged(map, town.poses, T_truth_map.inverse());
      LineScore score = score_lines(map.markings, T_truth_map, town.lines, std::cref(judged));
      score.driven = length_of(town.poses);
      figures[first + k].score.add(score);
      if (!arguments.pictures.empty())
        draw_markings(town.made.tiles, cells_of_truth(town.lines, T_truth_map.inverse()), map.markings,
                      fmt::format("{}/town_{}_{}_{}.png", arguments.pictures, paint_name, seed, k));
    }
  }
}

void bench(const Arguments& arguments) {
  MarkingFigures figures;
  if (!arguments.pictures.empty()) std::filesystem::create_directories(arguments.pictures);
  const bool wants_street = arguments.wants("street") || arguments.wants("driven");
  if (wants_street && std::filesystem::exists(arguments.data)) {
    if (arguments.wants("street")) figures.street = bench_street(arguments);
    if (arguments.wants("driven")) {
      for (const StreetFigures& driven : bench_driven(arguments)) figures.street.push_back(driven);
    }
    fmt::print("{}\n", to_table(figures.street));
  } else if (wants_street) {
    fmt::print("no labelled street: {} is not there\n", arguments.data);
  }
  if (arguments.wants("town")) {
    for (const std::string& paint : arguments.paints)
      bench_town(arguments, paint,
                 paint == "fresh"  ? simulate::paint::Paint::kFresh
                 : paint == "worn" ? simulate::paint::Paint::kWorn
                                   : simulate::paint::Paint::kNone,
                 figures.towns);
    fmt::print("{}\n", to_table(figures.towns));
  }
  if (!arguments.json.empty()) output::write_text(arguments.json, to_json(figures));
}

}  // namespace

int run_bench_markings(int argc, char** argv) {
  Arguments arguments;
  arguments.options.range = 30;
  ConfigOf<MarkingBenchConfig> config;
  CommandLine line("Precision, recall, lateral error and types of the road markings", "curbstone bench markings");
  line.option("--parts", arguments.parts, "Of street, driven, town")
      .comma_separated()
      .one_of({"street", "driven", "town"});
  line.option("--paint", arguments.paints, "Of fresh, worn, none: the towns'")
      .comma_separated()
      .one_of({"fresh", "worn", "none"});
  line.option("--seeds", arguments.seeds, "Towns, and drives through the street").within(1, 100).shows_default();
  line.option("--first-seed", arguments.first_seed, "Of the towns and drives").within(1, 1000).shows_default();
  line.option("--seconds", arguments.seconds, "Of each town's drive").within(5, 3600).shows_default();
  line.flag("--ablation", arguments.ablation, "One-sided, without the vote, one level everywhere; raw intensities too");
  line.flag("--one-scale", arguments.no_gains, "The towns' lasers have one scale of intensity");
  line.option("--data", arguments.data, "Labelled street: scans/, labels/, reference_poses.txt").shows_default();
  line.option("--set", arguments.assignments, "KEY=VALUE, as in section semantic_map").one_each();
  line.option("--pictures", arguments.pictures, "Folder for pictures of what was found");
  line.option("--json", arguments.json, "Write the figures here, for programs");
  if (const auto status = line.read(argc, argv)) return *status;
  for (const std::string& assignment : arguments.assignments) set_config_value(assignment, config);
  arguments.options.markings = config.value.markings;
  bench(arguments);
  return 0;
}

}  // namespace curbstone::bench::markings
