#include "tools/evaluate/evaluate.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "common/config/command_line.hpp"
#include "common/config/vehicle.hpp"
#include "services/semantic_map/picture/png_file.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "tools/evaluate/evaluation.hpp"
#include "tools/evaluate/map_difference.hpp"
#include "tools/evaluate/overlay.hpp"
#include "tools/evaluate/report.hpp"
#include "tools/evaluate/truth/street_labels.hpp"
#include "tools/output/text_file.hpp"
#include "tools/stored_picture/stored_picture.hpp"

namespace curbstone::evaluate {

namespace {

struct Arguments {
  std::string map;
  std::string truth;
  std::string other_map;
  std::string log;
  std::string labels;
  std::string picture;
  std::string overlay;
  std::string json;
  double radius = 8.0;
};

void add_options(CommandLine& line, Arguments& arguments) {
  line.option("--map", arguments.map, "The map").required();
  const auto truth =
      line.option("--truth", arguments.truth, "Truth folder: truth.json, poses.csv, classes.png, curbs.csv");
  line.option("--against", arguments.other_map,
              "Instead of the truth, another map of the drive, as of its replay: exit status 3 if they differ")
      .excludes(truth);
  line.option("--log", arguments.log, "Recording of the run: adds losses, latency and CPU");
  line.option("--radius", arguments.radius, "Curbs count within this many m of the path")
      .within(0.5, 100.0)
      .shows_default();
  line.option("--labels", arguments.labels,
              "Labelled scans of a recorded drive (SemanticKITTI: scans/, labels/, reference_poses.txt): its true "
              "curbs and classes");
  line.option("--picture", arguments.picture, "Draw the map (PNG)");
  line.option("--overlay", arguments.overlay,
              "Draw the map, the truth over it and dots where it errs (PNG): yellow for curbs it misses, cyan for such "
              "that are none, orange for obstacles called free, violet for road called blocked");
  line.option("--json", arguments.json, "Write the figures here, for programs");
}

/// The drive begins at its first scan, with the lidar at its default mounting.
void add_labels(const std::string& folder, truth::Truth& truth) {
  truth::StreetLabels labels =
      truth::read_street_labels(folder, truth.poses.front().pose * VehicleConfig{}.T_base_lidar());
  truth.curbs = std::move(labels.curbs);
  truth.classes = std::move(labels.classes);
}

int compare_maps(const std::string& file, const std::string& other_file) {
  const auto load = [](const std::string& name) {
    const semantic_map::store::MapReader reader(name);
    return StoredMap{reader.tiles(), reader.curbs(), reader.trajectory()};
  };
  const MapDifference d = difference(load(file), load(other_file));
  fmt::print("{}\n", to_line(d));
  return d.none() ? 0 : 3;
}

truth::Truth load_truth(const Arguments& arguments) {
  truth::Truth truth = truth::load_truth(arguments.truth);
  if (!arguments.labels.empty()) add_labels(arguments.labels, truth);
  return truth;
}

truth::Trajectory driven_path(const semantic_map::store::MapReader& map) {
  truth::Trajectory path;
  for (const semantic_map::tile::TrajectoryPose& pose : map.trajectory()) path.push_back({pose.utime, pose.T_map_base});
  return path;
}

/// `picture`: the map; the overlay is drawn on top.
void draw(semantic_map::picture::MapPicture picture, const Evaluation& evaluation, const truth::Truth& truth,
          const Arguments& arguments) {
  semantic_map::picture::PictureOptions drawing;
  drawing.title = fmt::format("{:.0f} m driven", evaluation.trajectory.distance_m);
  if (!arguments.picture.empty())
    semantic_map::picture::write_png(semantic_map::picture::draw_map(picture, drawing), arguments.picture);
  if (arguments.overlay.empty()) return;
  picture.overlays = truth_lines(truth, evaluation.T_truth_map);
  const auto errors = error_dots(evaluation);
  picture.overlays.insert(picture.overlays.end(), errors.begin(), errors.end());
  semantic_map::picture::write_png(semantic_map::picture::draw_map(picture, drawing), arguments.overlay);
}

int compare_with_truth(const Arguments& arguments) {
  const truth::Truth truth = load_truth(arguments);
  const semantic_map::store::MapReader map(arguments.map);
  semantic_map::picture::MapPicture picture = output::stored_picture(map);
  Evaluation evaluation = evaluate(picture.tiles, picture.curbs, driven_path(map), truth, arguments.radius);
  if (!arguments.log.empty()) evaluation.run = read_run_log(arguments.log);
  fmt::print("{}", to_table(evaluation));
  if (!arguments.json.empty()) output::write_text(arguments.json, to_json(evaluation));
  draw(std::move(picture), evaluation, truth, arguments);
  return evaluation.run && evaluation.run->log_is_damaged ? 1 : 0;
}

}  // namespace

int run_evaluate(int argc, char** argv) {
  Arguments arguments;
  CommandLine line("Compares a map with the truth that `curbstone simulate` wrote", "curbstone evaluate");
  add_options(line, arguments);
  if (const auto status = line.read(argc, argv)) return *status;
  if (!arguments.other_map.empty()) return compare_maps(arguments.map, arguments.other_map);
  if (!arguments.truth.empty()) return compare_with_truth(arguments);
  fmt::print(stderr, "curbstone evaluate: --truth or --against is needed; see --help\n");
  return 2;
}

}  // namespace curbstone::evaluate
