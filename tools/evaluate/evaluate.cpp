#include "tools/evaluate/evaluate.hpp"

#include <fmt/format.h>

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

/// The drive begins at its first scan, with the lidar where a vehicle has it by default.
void add_labels(const std::string& folder, truth::Truth& truth) {
  truth::StreetLabels labels =
      truth::read_street_labels(folder, truth.poses.front().pose * VehicleConfig{}.T_base_lidar());
  truth.curbs = std::move(labels.curbs);
  truth.classes = std::move(labels.classes);
}

int compare(const std::string& file, const std::string& other_file) {
  const auto load = [](const std::string& name) {
    const semantic_map::store::MapReader reader(name);
    return StoredMap{reader.tiles(), reader.curbs(), reader.trajectory()};
  };
  const MapDifference d = difference(load(file), load(other_file));
  fmt::print("{}\n", to_line(d));
  return d.none() ? 0 : 3;
}

}  // namespace

int run_evaluate(int argc, char** argv) {
  std::string map_file;
  std::string truth_folder;
  std::string log_file;
  std::string json_file;
  std::string label_folder;
  std::string picture_file;
  std::string overlay_file;
  std::string other_file;
  double radius = 8.0;
  CommandLine line("Compares a map with the truth that `curbstone simulate` wrote", "curbstone evaluate");
  line.option("--map", map_file, "The map").required();
  const auto truth_option =
      line.option("--truth", truth_folder, "Truth folder: truth.json, poses.csv, classes.png, curbs.csv");
  line.option("--against", other_file,
              "Instead of the truth, another map of the drive, as of its replay: exit status 3 if they differ")
      .excludes(truth_option);
  line.option("--log", log_file, "Recording of the run: adds losses, latency and CPU");
  line.option("--radius", radius, "Curbs count within this many m of the path").within(0.5, 100.0).shows_default();
  line.option("--labels", label_folder,
              "Labelled scans of a recorded drive (SemanticKITTI: scans/, labels/, reference_poses.txt): its true "
              "curbs and classes");
  line.option("--picture", picture_file, "Draw the map (PNG)");
  line.option("--overlay", overlay_file,
              "Draw the map, the truth over it and dots where it errs (PNG): yellow for curbs it misses, cyan for such "
              "that are none, orange for obstacles called free");
  line.option("--json", json_file, "Write the figures here, for programs");
  if (const auto status = line.read(argc, argv)) return *status;

  if (!other_file.empty()) return compare(map_file, other_file);
  if (truth_folder.empty()) {
    fmt::print(stderr, "curbstone evaluate: --truth or --against is needed; see --help\n");
    return 2;
  }
  truth::Truth truth = truth::load_truth(truth_folder);
  if (!label_folder.empty()) add_labels(label_folder, truth);
  const semantic_map::store::MapReader map(map_file);
  truth::Trajectory trajectory;
  semantic_map::picture::MapPicture picture = output::stored_picture(map);
  for (const semantic_map::tile::TrajectoryPose& pose : map.trajectory())
    trajectory.push_back({pose.utime, pose.T_map_base});
  Evaluation evaluation = evaluate(picture.tiles, picture.curbs, trajectory, truth, radius);
  if (!log_file.empty()) evaluation.run = read_run_log(log_file);
  fmt::print("{}", to_table(evaluation));
  if (!json_file.empty()) output::write_text(json_file, to_json(evaluation));
  semantic_map::picture::PictureOptions drawing;
  drawing.title = fmt::format("{:.0f} m driven", evaluation.trajectory.distance_m);
  if (!picture_file.empty())
    semantic_map::picture::write_png(semantic_map::picture::draw_map(picture, drawing), picture_file);
  if (!overlay_file.empty()) {
    picture.overlays = truth_lines(truth, evaluation.T_truth_map);
    const auto errors = error_dots(evaluation);
    picture.overlays.insert(picture.overlays.end(), errors.begin(), errors.end());
    semantic_map::picture::write_png(semantic_map::picture::draw_map(picture, drawing), overlay_file);
  }
  return evaluation.run && evaluation.run->log_is_damaged ? 1 : 0;
}

}  // namespace curbstone::evaluate
