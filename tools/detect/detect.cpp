#include "tools/detect/detect.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "common/config/command_line.hpp"
#include "services/semantic_map/picture/map_picture.hpp"
#include "services/semantic_map/picture/png_file.hpp"
#include "tools/detect/cloud_check.hpp"
#include "tools/detect/cloud_file.hpp"
#include "tools/detect/cloud_map/cloud_map.hpp"
#include "tools/detect/method_steps.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/text_file.hpp"

namespace curbstone::detect {

namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string cloud;
  std::string poses;
  std::string out;
  std::string steps;
  double min_range = 0;
  std::vector<double> origin;  // X,Y,Z; may be empty
  std::vector<std::string> assignments;
  cloud_map::CloudMapOptions options;
};

/// The parameters for --set.
struct DetectConfig {
  semantic_map::tile::CurbParameters curb;
  semantic_map::cells::ClassParameters classes;
  void visit(ConfigVisitor& v) {
    v.section("curb", curb, "how curbs are found");
    v.section("classes", classes, "classes and costs of cells");
  }
};

Eigen::Vector3d origin_of(const Arguments& arguments) {
  return arguments.origin.empty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(arguments.origin.data());
}

std::vector<Eigen::Vector3f> read_input(const Arguments& arguments) {
  if (!fs::is_directory(arguments.cloud)) return read_cloud(arguments.cloud, origin_of(arguments));
  if (arguments.poses.empty())
    throw CloudFileError(fmt::format("{}: is a folder: give the scans' poses with --poses FILE", arguments.cloud));
  return read_cloud_folder(arguments.cloud, arguments.poses, arguments.min_range, origin_of(arguments));
}

/// In the file's own coordinates.
void write_curbs(const std::vector<cloud_map::CloudCurb>& curbs, const Eigen::Vector3d& origin,
                 const std::string& path) {
  std::string rows = "x,y,z,height\n";
  for (const cloud_map::CloudCurb& c : curbs) {
    const Eigen::Vector3d foot = c.foot + origin;
    rows += fmt::format("{:.3f},{:.3f},{:.3f},{:.3f}\n", foot.x(), foot.y(), foot.z(), c.height);
  }
  output::write_text(path, rows);
}

/// The part that is drawn: 40 m around, where a single scan still measures the ground.
semantic_map::picture::MapPicture picture_of(const cloud_map::CloudMap& map, double range) {
  semantic_map::picture::MapPicture picture;
  for (const semantic_map::tile::MapTile& tile : map.tiles) {
    const Eigen::Vector2d centre((tile.key.x + 0.5) * kTileSize, (tile.key.y + 0.5) * kTileSize);
    if (range <= 0 || centre.norm() < range) picture.tiles.push_back(tile);
  }
  return picture;
}

/// One picture per step of the method, and the result.
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

/// The reason why no point of a cloud can be used, and what to do.
std::string why_none(const std::vector<Eigen::Vector3f>& cloud, const cloud_map::CloudMap& map,
                     const Arguments& arguments) {
  std::string reason = fmt::format("{}: none of its {} points can be used ({} not finite, {} out of range)",
                                   arguments.cloud, cloud.size(), map.not_finite, map.out_of_range);
  if (const auto middle = middle_of(cloud)) {
    const Eigen::Vector3d there = *middle + origin_of(arguments);
    reason += fmt::format(
        "; their middle is {:.0f}, {:.0f}, {:.0f}: if that is in m, --origin {:.0f},{:.0f},{:.0f} looks there",
        there.x(), there.y(), there.z(), there.x(), there.y(), there.z());
  }
  return reason;
}

int detect(const Arguments& arguments) {
  const std::vector<Eigen::Vector3f> cloud = read_input(arguments);
  const cloud_map::CloudMap map = cloud_map::map_cloud(cloud, arguments.options);
  if (map.points.empty()) throw CloudFileError(why_none(cloud, map, arguments));
  if (seems_upside_down(cloud)) {
    fmt::print(stderr, "curbstone detect: {}: most points lie high up, as if z pointed down; the method needs z up\n",
               arguments.cloud);
  }
  const std::string stem = fs::path(arguments.cloud).lexically_normal().stem().string();
  const std::string name = stem.empty() ? "cloud" : stem;
  output::OutputFolder outputs(arguments.out);
  outputs.add(name + "_labelled.pcd", [&](const std::string& path) { write_labelled_pcd(map.points, path); });
  outputs.add("curbs.csv", [&](const std::string& path) { write_curbs(map.curbs, origin_of(arguments), path); });
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
  line.option("--origin", arguments.origin,
              "X,Y,Z in the coordinates of the file, or of the poses: taken for the origin, as georeferenced clouds "
              "need it; curbs.csv has the coordinates as they came")
      .comma_separated();
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
  if (!arguments.origin.empty() && arguments.origin.size() != 3) return line.refuse("--origin: three numbers, X,Y,Z");
  for (const std::string& assignment : arguments.assignments) set_config_value(assignment, config);
  arguments.options.curb = config.value.curb;
  arguments.options.classes = config.value.classes;
  return detect(arguments);
}

}  // namespace curbstone::detect
