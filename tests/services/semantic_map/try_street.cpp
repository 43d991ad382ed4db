// A workbench: the method on the labelled street, with parameters from the command line (KEY=VALUE), figures and
// pictures.
#include <fmt/format.h>

#include <chrono>

#include "services/semantic_map/map_picture.hpp"
#include "services/semantic_map/png_file.hpp"
#include "street_truth.hpp"
#include "tools/detect/cloud_map.hpp"

using namespace curbstone;

namespace {

struct Settings {
  CurbParameters curb;
  ClassParameters classes;
  void visit(ConfigVisitor& v) {
    v.section("curb", curb, "");
    v.section("classes", classes, "");
  }
};

struct Case {
  std::string name;
  std::vector<Eigen::Vector3f> cloud;
};

std::vector<Case> make_cases(const std::filesystem::path& folder) {
  const auto poses = read_poses(folder / "reference_poses.txt");
  std::vector<Case> cases{{"merged", {}}, {"single", {}}, {"beams16", {}}};
  for (std::size_t k = 0; k < 16; ++k) {
    const auto scan = read_scan(folder / "scans" / fmt::format("{:06d}.bin", k));
    if (k == 0) cases[1].cloud = scan;
    for (std::size_t i = 0; i < scan.size(); ++i) {
      const Eigen::Vector3f p = (poses[k] * scan[i].cast<double>()).cast<float>();
      cases[0].cloud.push_back(p);
      // The RS16's beams: 2 degrees apart from -15 degrees on, as far as the HDL-64 has them.
      const double elevation =
          std::atan2(double{scan[i].z()}, std::hypot(double{scan[i].x()}, double{scan[i].y()})) * 57.29578;
      const double beam = std::round((elevation + 15) / 2);
      if (beam >= 0 && beam < 16 && std::abs(elevation + 15 - 2 * beam) < 0.2) cases[2].cloud.push_back(p);
    }
  }
  return cases;
}

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path folder = std::filesystem::path(CURBSTONE_DATA_DIR) / "kitti00";
  ConfigOf<Settings> settings;
  std::string out;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.starts_with("--out="))
      out = argument.substr(6);
    else
      set_config_value(argument, settings);
  }
  const StreetTruth truth = make_street_truth(folder);
  for (const Case& c : make_cases(folder)) {
    CloudMapOptions options;
    options.curb = settings.value.curb;
    options.classes = settings.value.classes;
    options.range = 30;
    CloudMap map;
    const double start = seconds();
    const auto tiles = vote_tiles(c.cloud, options, map);
    const double voted = seconds();
    map_tiles(tiles, options, map);
    const double mapped = seconds();
    std::vector<Detection> detections;
    for (const CloudCurb& curb : map.curbs) detections.push_back({curb.foot.head<2>(), curb.up});
    for (const double tolerance : {0.12, 0.24}) {
      const StreetScore s = score_street(detections, truth, tolerance, 15);
      fmt::print("{:8} {:.2f} m: P {:.3f} R {:.3f} F1 {:.3f}  ({} of {} truth; {} detections, {} don't care)", c.name,
                 tolerance, s.precision, s.recall, s.f1, s.found, s.truth, s.detections, s.dont_care);
      if (tolerance > 0.2)
        fmt::print("  bias {:.1f} spread {:.1f} cm  by step {:.2f} {:.2f} {:.2f} {:.2f} {:.2f}", 100 * s.bias,
                   100 * s.spread, s.recall_by_step[0], s.recall_by_step[1], s.recall_by_step[2], s.recall_by_step[3],
                   s.recall_by_step[4]);
      fmt::print("\n");
    }
    fmt::print("         {} points, {} tiles, vote {:.2f} s, map {:.2f} s\n", map.points.size(), map.tiles.size(),
               voted - start, mapped - voted);
    if (!out.empty()) {
      MapPicture picture;
      picture.tiles = map.tiles;
      for (const TruthPoint& t : truth.points) {
        const Colour colour = !t.counts        ? Colour{90, 90, 255}
                              : t.step >= 0.04 ? Colour{255, 0, 200}
                                               : Colour{255, 150, 230};
        picture.overlays.push_back({{t.at, t.at + Eigen::Vector2d(0.05, 0)}, colour, 3});
      }
      std::erase_if(picture.tiles, [](const MapTile& t) { return std::abs(t.key.x) > 6 || std::abs(t.key.y) > 6; });
      write_png(draw_map(picture, {.title = "", .pixels_per_cell = 4}), out + "/" + c.name + ".png");
    }
  }
  return 0;
}
