#include "tools/bench/curbs/bench_curbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numbers>

#include "common/config/command_line.hpp"
#include "services/semantic_map/picture/map_picture.hpp"
#include "services/semantic_map/picture/png_file.hpp"
#include "tools/bench/curbs/curb_tables.hpp"
#include "tools/bench/curbs/scenes/hdl64.hpp"
#include "tools/bench/curbs/scenes/scene_drive.hpp"
#include "tools/bench/curbs/scenes/street_clouds.hpp"
#include "tools/bench/curbs/scenes/town_drive.hpp"
#include "tools/bench/curbs/scores/curb_feet.hpp"
#include "tools/detect/cloud_map/cloud_map.hpp"
#include "tools/output/text_file.hpp"

namespace curbstone::bench::curbs {

namespace {

struct Arguments {
  std::vector<std::string> parts = {"scans", "drives", "town", "street"};
  std::string data = "../shared/data/kitti00";
  std::string json;
  std::string pictures;
  int seeds = 10;
  int drive_seeds = 3;
  int turns = 1;
  scenes::ScanLoss loss;
  bool varied = false;
  bool ablation = false;
  std::vector<std::string> assignments;
  detect::cloud_map::CloudMapOptions options;

  [[nodiscard]] bool wants(const std::string& part) const {
    return std::find(parts.begin(), parts.end(), part) != parts.end();
  }
};

/// The parameters for --set.
struct CurbBenchConfig {
  semantic_map::tile::CurbParameters curb;
  semantic_map::cells::ClassParameters classes;
  void visit(ConfigVisitor& v) {
    v.section("curb", curb, "how curbs are found");
    v.section("classes", classes, "classes and costs of cells");
  }
};

struct CurbMethod {
  std::string name;
  detect::cloud_map::CloudMapOptions options;
};

/// The method, and with `ablation` each of its two cues alone, to measure the benefit of the vote.
std::vector<CurbMethod> methods(const detect::cloud_map::CloudMapOptions& options, bool ablation) {
  std::vector<CurbMethod> methods = {{"both cues", options}};
  if (!ablation) return methods;
  methods.push_back({"step only", options});
  methods.back().options.curb.use_tilt = false;
  methods.push_back({"vote only", options});
  methods.back().options.curb.use_step = false;
  return methods;
}

detect::cloud_map::CloudMap map_of(const std::vector<semantic_map::tile::VotedTile>& tiles,
                                   const detect::cloud_map::CloudMapOptions& options) {
  detect::cloud_map::CloudMap map;
  detect::cloud_map::map_tiles(tiles, options, map);
  return map;
}

/// Transforms heights too: a sensor on a slope is displaced sideways relative to what it measures on the ground.
std::vector<semantic_map::tile::CurbLine> moved(std::vector<semantic_map::tile::CurbLine> lines, const Pose& T) {
  for (semantic_map::tile::CurbLine& line : lines) {
    for (semantic_map::tile::CurbVertex& v : line.points) {
      const Eigen::Vector3f at = (T * Eigen::Vector3f(v.x, v.y, v.z).cast<double>()).cast<float>();
      const Eigen::Vector3f up = T.linear().cast<float>() * Eigen::Vector3f(v.high_side_x, v.high_side_y, 0);
      v = {.x = at.x(), .y = at.y(), .z = at.z(), .height = v.height, .high_side_x = up.x(), .high_side_y = up.y()};
    }
  }
  return lines;
}

std::vector<scenes::CurbSceneOptions> scenes_of(const Arguments& arguments) {
  return arguments.varied ? scenes::varied_scenes() : scenes::peer_scenes();
}

std::string method_suffix(const CurbMethod& method, bool ablation) {
  return ablation ? ", " + method.name : "";
}

void draw(const detect::cloud_map::CloudMap& map, const std::vector<semantic_map::picture::PictureLine>& overlay,
          const std::string& file) {
  semantic_map::picture::MapPicture picture;
  for (const semantic_map::tile::MapTile& tile : map.tiles) {
    if (std::abs(tile.key.x) <= 6 && std::abs(tile.key.y) <= 5) picture.tiles.push_back(tile);
  }
  if (overlay.empty()) picture.curbs = map.lines;
  picture.overlays = overlay;
  const std::string title = overlay.empty() ? "" : "dots: magenta truth, green right, red wrong, yellow not counted";
  semantic_map::picture::write_png(semantic_map::picture::draw_map(picture, {.title = title, .pixels_per_cell = 6}),
                                   file);
}

std::vector<SceneFigures> bench_scans(const Arguments& arguments) {
  std::vector<SceneFigures> figures;
  const double lidar_height = VehicleConfig{}.lidar[2];
  for (const scenes::CurbSceneOptions& options : scenes_of(arguments)) {
    const std::vector<CurbMethod> ways = methods(arguments.options, arguments.ablation);
    const std::size_t first = figures.size();
    for (const CurbMethod& way : ways) figures.push_back({options.name + method_suffix(way, arguments.ablation), {}});
    for (int seed = 1; seed <= arguments.seeds; ++seed) {
      const scenes::CurbScene scene(options, static_cast<std::uint64_t>(seed));
      Pose T_world_lidar = scene.T_world_base(0);
      T_world_lidar.translation() += lidar_height * T_world_lidar.linear().col(2);
      const auto scan =
          scenes::scan_hdl64(scene.scene(), T_world_lidar, options.noise, static_cast<std::uint64_t>(seed));
      detect::cloud_map::CloudMap counts;
      const auto tiles = detect::cloud_map::vote_tiles(scan, arguments.options, counts);
      for (std::size_t k = 0; k < ways.size(); ++k) {
        const detect::cloud_map::CloudMap map = map_of(tiles, ways[k].options);
        const auto feet = scores::feet_along(moved(map.lines, T_world_lidar));
        figures[first + k].scores.push_back(scores::score_bins(feet, scene, {T_world_lidar.translation()}));
        if (!arguments.pictures.empty() && seed == 1)
          draw(map, {}, fmt::format("{}/scan_{}.png", arguments.pictures, first + k));
      }
    }
  }
  return figures;
}

std::vector<SceneFigures> bench_drives(const Arguments& arguments) {
  std::vector<SceneFigures> figures;
  for (const scenes::CurbSceneOptions& options : scenes_of(arguments)) {
    const std::vector<CurbMethod> ways = methods(arguments.options, arguments.ablation);
    const std::size_t first = figures.size();
    for (const CurbMethod& way : ways) figures.push_back({options.name + method_suffix(way, arguments.ablation), {}});
    for (int seed = 1; seed <= arguments.drive_seeds; ++seed) {
      const scenes::CurbScene scene(options, static_cast<std::uint64_t>(seed));
      const scenes::SceneDrive drive = scenes::drive_scene(scene, static_cast<std::uint64_t>(seed));
      for (std::size_t k = 0; k < ways.size(); ++k) {
        const detect::cloud_map::CloudMap map = map_of(drive.made.tiles, ways[k].options);
        figures[first + k].scores.push_back(
            scores::score_bins(scores::feet_along(moved(map.lines, drive.T_world_map)), scene, drive.eyes));
        if (!arguments.pictures.empty() && seed == 1)
          draw(map, {}, fmt::format("{}/drive_{}.png", arguments.pictures, first + k));
      }
    }
  }
  return figures;
}

/// Colours: true curbs magenta, lower steps pink, other borders blue; detections green if right, red if wrong, yellow
/// if they do not count.
std::vector<semantic_map::picture::PictureLine> verdict_lines(const evaluate::truth::StreetLabels& truth,
                                                              const std::vector<evaluate::CurbFoot>& feet) {
  std::vector<semantic_map::picture::PictureLine> lines;
  const auto dot = [&](double x, double y, semantic_map::picture::Colour colour, double thickness) {
    lines.push_back({{{x, y}, {x + 0.02, y}}, colour, thickness});
  };
  for (const evaluate::truth::TrueCurbPoint& t : truth.curbs)
    dot(t.x, t.y,
        !t.dropped      ? semantic_map::picture::Colour{255, 0, 200}
        : t.height != 0 ? semantic_map::picture::Colour{255, 150, 230}
                        : semantic_map::picture::Colour{90, 90, 255},
        5);
  for (const evaluate::CurbFoot& foot : feet) {
    const scores::Verdict verdict = scores::judge(foot, truth, evaluate::kTolerances.back());
    dot(foot.at.x, foot.at.y,
        verdict == scores::Verdict::kRight   ? semantic_map::picture::Colour{0, 230, 0}
        : verdict == scores::Verdict::kWrong ? semantic_map::picture::Colour{255, 30, 0}
                                             : semantic_map::picture::Colour{250, 240, 0},
        3);
  }
  return lines;
}

void draw(const detect::cloud_map::CloudMap& map, const scenes::JudgedDrive& drive,
          const evaluate::Evaluation& evaluation, const std::string& file) {
  const evaluate::truth::StreetLabels truth{drive.truth.curbs, drive.truth.classes};
  auto lines = verdict_lines(truth, scores::feet_along(moved(map.lines, evaluation.T_truth_map)));
  const Pose T_map_truth = evaluation.T_truth_map.inverse();
  for (semantic_map::picture::PictureLine& line : lines) {
    for (Eigen::Vector2d& p : line.points) p = (T_map_truth * Eigen::Vector3d(p.x(), p.y(), 0)).head<2>();
  }
  draw(map, lines, file);
}

/// Evaluates the drives that `drive_of` makes of the seeds; curbs count within `radius` m of the path.
template <class DriveOf>
void bench_whole_drives(const Arguments& arguments, const std::string& name, double radius, DriveOf drive_of,
                        std::vector<DriveFigures>& figures) {
  const std::vector<CurbMethod> ways = methods(arguments.options, arguments.ablation);
  const std::size_t first = figures.size();
  for (const CurbMethod& way : ways) figures.push_back({name, way.name, {}});
  for (int seed = 1; seed <= arguments.drive_seeds; ++seed) {
    const scenes::JudgedDrive drive = drive_of(static_cast<std::uint64_t>(seed));
    for (std::size_t k = 0; k < ways.size(); ++k) {
      const detect::cloud_map::CloudMap map = map_of(drive.made.tiles, ways[k].options);
      std::vector<evaluate::Evaluation>& evaluations = figures[first + k].seeds;
      evaluations.push_back(evaluate::evaluate(map.tiles, map.lines, drive.made.trajectory, drive.truth, radius));
      if (!arguments.pictures.empty())
        draw(map, drive, evaluations.back(),
             fmt::format("{}/{}_{}_{}.png", arguments.pictures, name, seed, ways[k].name));
    }
  }
}

/// The street turned by `turn` deg about the sensor, relative to the map's grid.
std::vector<StreetFigures> bench_street(const Arguments& arguments, double turn) {
  std::vector<StreetFigures> figures;
  Pose T_world_first = Pose::Identity();
  T_world_first.rotate(Eigen::AngleAxisd(turn / 180 * std::numbers::pi, Eigen::Vector3d::UnitZ()));
  const evaluate::truth::StreetLabels truth = evaluate::truth::read_street_labels(arguments.data, T_world_first);
  for (const scenes::StreetCloud& cloud : scenes::read_street_clouds(arguments.data, T_world_first, arguments.loss)) {
    detect::cloud_map::CloudMap counts;
    const auto tiles = detect::cloud_map::vote_tiles(cloud.points, arguments.options, counts);
    for (const CurbMethod& way : methods(arguments.options, true)) {
      const detect::cloud_map::CloudMap map = map_of(tiles, way.options);
      const std::vector<evaluate::CurbFoot> feet = scores::feet_along(map.lines);
      figures.push_back({cloud.name, way.name, {}});
      auto& scores = figures.back().turns.emplace_back();
      for (const double tolerance : evaluate::kTolerances)
        scores.push_back(scores::score_street(feet, truth, tolerance));
      if (!arguments.pictures.empty())
        draw(map, verdict_lines(truth, feet),
             fmt::format("{}/street_{}_{}_{:.0f}.png", arguments.pictures, cloud.name, way.name, turn));
    }
  }
  return figures;
}

/// All turns within 90 deg: a square grid turned by 90 deg is unchanged.
std::vector<StreetFigures> bench_street(const Arguments& arguments) {
  std::vector<StreetFigures> figures = bench_street(arguments, 0);
  for (int k = 1; k < arguments.turns; ++k) {
    const std::vector<StreetFigures> turned = bench_street(arguments, 90.0 * k / arguments.turns);
    for (std::size_t i = 0; i < figures.size(); ++i) figures[i].turns.push_back(turned[i].turns.front());
  }
  return figures;
}

void bench(const Arguments& arguments) {
  CurbFigures figures;
  if (!arguments.pictures.empty()) std::filesystem::create_directories(arguments.pictures);
  const bool has_street = std::filesystem::exists(arguments.data);
  if (arguments.wants("street") && has_street) {
    figures.street = bench_street(arguments);
    fmt::print("{}\n", to_table(figures.street));
  }
  if (arguments.wants("scans")) {
    figures.scans = bench_scans(arguments);
    fmt::print("{}\n", to_table("single HDL-64 scans", figures.scans));
  }
  if (arguments.wants("drives")) {
    figures.drives = bench_drives(arguments);
    fmt::print("{}\n", to_table("driven through, RS16", figures.drives));
  }
  if (arguments.wants("town"))
    bench_whole_drives(
        arguments, "towns, 60 s", 8, [](std::uint64_t seed) { return scenes::drive_town(seed, 60); }, figures.towns);
  if (arguments.wants("street") && has_street && std::filesystem::exists(arguments.data + "/reference_poses.txt"))
    bench_whole_drives(
        arguments, "labelled street, RS16", 15,
        [&](std::uint64_t seed) { return scenes::drive_recorded(arguments.data, seed); }, figures.towns);
  if (!figures.towns.empty()) fmt::print("{}", to_table(figures.towns));
  if (arguments.wants("street") && !has_street) fmt::print("no labelled street: {} is not there\n", arguments.data);
  if (!arguments.json.empty()) output::write_text(arguments.json, to_json(figures));
}

}  // namespace

int run_bench_curbs(int argc, char** argv) {
  Arguments arguments;
  arguments.options.range = 30;
  ConfigOf<CurbBenchConfig> config;
  CommandLine line("Precision, recall and lateral error of the curbs", "curbstone bench curbs");
  line.option("--parts", arguments.parts, "Of scans, drives, town, street")
      .comma_separated()
      .one_of({"scans", "drives", "town", "street"});
  line.option("--seeds", arguments.seeds, "Of each scene's scan").within(1, 1000).shows_default();
  line.option("--drive-seeds", arguments.drive_seeds,
              "Of each scene's drive, of towns, of the street's emulated sensors")
      .within(1, 1000)
      .shows_default();
  line.option("--turns", arguments.turns, "Ways, through 90 deg, that the street's clouds are laid onto the grid")
      .within(1, 90)
      .shows_default();
  line.option("--street-noise", arguments.loss.range_noise, "m of range, 1 sigma, added to the street's clouds")
      .within(0.0, 1.0)
      .shows_default();
  line.option("--street-kept", arguments.loss.kept, "Share of the points that the street's clouds keep")
      .within(0.01, 1.0)
      .shows_default();
  line.option("--street-lasers", arguments.loss.lasers, "One laser in so many that the street's clouds keep")
      .within(1, 64)
      .shows_default();
  line.flag("--varied", arguments.varied, "Other scenes than the peers': what no parameter was chosen on");
  line.flag("--ablation", arguments.ablation, "The step alone and the vote alone too (on the street always)");
  line.option(
          "--data", arguments.data,
          "Labelled street: scans/, labels/ (and labels.csv, where labels are not SemanticKITTI's), "
          "reference_poses.txt, times.txt; or one scan without poses; or clicked curbs, curbs.csv, in place of labels")
      .shows_default();
  line.option("--set", arguments.assignments, "KEY=VALUE, as in section semantic_map").one_each();
  line.option("--pictures", arguments.pictures, "Folder for pictures of what was found");
  line.option("--json", arguments.json, "Write the figures here, for programs");
  if (const auto status = line.read(argc, argv)) return *status;
  for (const std::string& assignment : arguments.assignments) set_config_value(assignment, config);
  arguments.options.curb = config.value.curb;
  arguments.options.classes = config.value.classes;
  bench(arguments);
  return 0;
}

}  // namespace curbstone::bench::curbs
