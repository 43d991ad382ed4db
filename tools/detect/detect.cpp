#include "tools/detect/detect.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/config/command_line.hpp"
#include "services/semantic_map/picture/map_picture.hpp"
#include "services/semantic_map/picture/png_file.hpp"
#include "tools/detect/cloud_file.hpp"
#include "tools/detect/cloud_map/cloud_map.hpp"
#include "tools/detect/method_steps.hpp"
#include "tools/output/output_folder.hpp"

namespace curbstone::detect {

namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string cloud;
  std::string poses;
  std::string out;
  std::string steps;
  double min_range = 0;
  std::vector<std::string> assignments;
  cloud_map::CloudMapOptions options;
};

/// What can be set with --set.
struct DetectConfig {
  semantic_map::tile::CurbParameters curb;
  semantic_map::cells::ClassParameters classes;
  void visit(ConfigVisitor& v) {
    v.section("curb", curb, "how curbs are found");
    v.section("classes", classes, "what blocks and what does not");
  }
};

std::vector<Eigen::Vector3f> read_input(const Arguments& arguments) {
  if (!fs::is_directory(arguments.cloud)) return read_cloud(arguments.cloud);
  if (arguments.poses.empty())
    throw CloudFileError(fmt::format("{}: is a folder: give the scans' poses with --poses FILE", arguments.cloud));
  return read_cloud_folder(arguments.cloud, arguments.poses, arguments.min_range);
}

void write_curbs(const std::vector<cloud_map::CloudCurb>& curbs, const std::string& path) {
  std::ofstream out(path);
  out << "x,y,z,height\n";
  for (const cloud_map::CloudCurb& c : curbs)
    out << fmt::format("{:.3f},{:.3f},{:.3f},{:.3f}\n", c.foot.x(), c.foot.y(), c.foot.z(), c.height);
  out.flush();
  if (!out) throw CloudFileError(fmt::format("{}: cannot be written: {}", path, std::strerror(errno)));
}

/// What is worth a picture: 40 m around, where a single scan still sees the ground.
semantic_map::picture::MapPicture picture_of(const cloud_map::CloudMap& map, double range) {
  semantic_map::picture::MapPicture picture;
  for (const semantic_map::tile::MapTile& tile : map.tiles) {
    const Eigen::Vector2d centre((tile.key.x + 0.5) * kTileSize, (tile.key.y + 0.5) * kTileSize);
    if (range <= 0 || centre.norm() < range) picture.tiles.push_back(tile);
  }
  return picture;
}

/// One picture a step of the method, and the result.
void write_steps(const std::vector<Eigen::Vector3f>& cloud, const Arguments& arguments,
                 const cloud_map::CloudMap& map) {
  output::OutputFolder outputs(arguments.steps);
  cloud_map::CloudMap counts;
  const auto tiles = cloud_map::vote_tiles(cloud, arguments.options, counts);
  for (const StepPicture& step : draw_method_steps(tiles, arguments.options, arguments.options.range))
    outputs.add(step.name + ".png",
                [&](const std::string& path) { semantic_map::picture::write_png(step.canvas, path); });
  outputs.add("8_result.png", [&](const std::string& path) {
    semantic_map::picture::MapPicture picture = picture_of(map, arguments.options.range);
    picture.curbs = map.lines;
    picture.markings = map.markings;
    semantic_map::picture::write_png(
        semantic_map::picture::draw_map(picture, {.title = "curbs and classes", .pixels_per_cell = 6}), path);
  });
  outputs.commit();
}

int detect(const Arguments& arguments) {
  const std::vector<Eigen::Vector3f> cloud = read_input(arguments);
  const cloud_map::CloudMap map = cloud_map::map_cloud(cloud, arguments.options);
  if (map.points.empty())
    throw CloudFileError(fmt::format("{}: none of its {} points can be used ({} not finite, {} out of range)",
                                     arguments.cloud, cloud.size(), map.not_finite, map.out_of_range));
  const std::string stem = fs::path(arguments.cloud).lexically_normal().stem().string();
  const std::string name = stem.empty() ? "cloud" : stem;
  output::OutputFolder outputs(arguments.out);
  outputs.add(name + "_labelled.pcd", [&](const std::string& path) { write_labelled_pcd(map.points, path); });
  outputs.add("curbs.csv", [&](const std::string& path) { write_curbs(map.curbs, path); });
  outputs.add(name + ".png", [&](const std::string& path) {
    semantic_map::picture::write_png(semantic_map::picture::draw_map(picture_of(map, arguments.options.range),
                                                                     {.title = name, .pixels_per_cell = 6}),
                                     path);
  });
  const std::vector<std::string> files = outputs.commit();
  if (!arguments.steps.empty()) write_steps(cloud, arguments, map);
  fmt::print("{} points, {} used ({} not finite, {} out of range); {} curb points\n", cloud.size(), map.points.size(),
             map.not_finite, map.out_of_range, map.curbs.size());
  for (const std::string& file : files) fmt::print("{}\n", (fs::path(arguments.out) / file).string());
  return 0;
}

}  // namespace

int run_detect(int argc, char** argv) {
  Arguments arguments;
  arguments.out = ".";
  arguments.options.range = 50;
  ConfigOf<DetectConfig> config;
  CommandLine line("Curbs and classes of any cloud, z up: writes a labelled .pcd, curbs.csv and a .png from above",
                   "detect");
  line.argument("cloud", arguments.cloud, ".pcd, .ply, KITTI .bin, or a folder of scans with --poses").required();
  line.option("--poses", arguments.poses, "For a folder: 3x4 rows, scan to map, one a scan in the order of names");
  line.option("--min-range", arguments.min_range,
              "For a folder: m from the sensor; nearer returns, the recording vehicle's own, are left out")
      .not_negative()
      .shows_default();
  line.option("--out", arguments.out, "Folder for the results").shows_default();
  line.option("--steps", arguments.steps, "Folder for one picture a step of the method");
  line.option("--range", arguments.options.range, "m from the origin that are looked at; 0: all")
      .not_negative()
      .shows_default();
  line.option("--thin", arguments.options.thin, "m: one point is used in a cube of this edge; 0: all")
      .within(0.0, 1.0)
      .shows_default();
  line.option("--set", arguments.assignments, "KEY=VALUE, as in section semantic_map: curb.min_step=0.05").one_each();
  if (const auto status = line.read(argc, argv)) return *status;
  try {
    for (const std::string& assignment : arguments.assignments) set_config_value(assignment, config);
  } catch (const ConfigError& error) {
    fmt::print(stderr, "curbstone detect: {}\n", error.what());
    return 2;
  }
  arguments.options.curb = config.value.curb;
  arguments.options.classes = config.value.classes;
  try {
    return detect(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "curbstone detect: {}\n", error.what());
    return 1;
  }
}

}  // namespace curbstone::detect
