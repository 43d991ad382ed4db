#include "tools/simulate/truth/truth_folder.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>

#include "common/json/json_text.hpp"
#include "tools/simulate/truth/class_grid.hpp"
#include "tools/simulate/truth/curb_lines.hpp"

namespace curbstone::simulate::truth {

namespace {

/// Writes a complete file or throws, and leaves no partial file.
void write_file(const std::string& folder, const std::string& name, const std::string& text) {
  const std::string file = folder + "/" + name;
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (out) return;
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  throw std::runtime_error(fmt::format("{}: cannot be written: is the disk full?", file));
}

void write_poses(const std::string& folder, const TruthInfo& info, const motion::Motion& motion) {
  constexpr int kRate = 100;  // Hz
  std::string text = "utime,x,y,z,qw,qx,qy,qz\n";
  for (int i = 0; i <= static_cast<int>(info.seconds * kRate); ++i) {
    const double t = static_cast<double>(i) / kRate;
    const Pose T = motion.T_world_base(t);
    const Eigen::Quaterniond q(T.linear());
    text +=
        fmt::format("{},{:.5f},{:.5f},{:.5f},{:.8f},{:.8f},{:.8f},{:.8f}\n", info.start_utime + std::llround(t * 1e6),
                    T.translation().x(), T.translation().y(), T.translation().z(), q.w(), q.x(), q.y(), q.z());
  }
  write_file(folder, "poses.csv", text);
}

/// One row per vertex of a piece's centre line.
void write_markings(const std::string& folder, const world::Ground& ground, std::span<const paint::Marking> markings) {
  std::string text = "line,piece,type,width,x,y,z\n";
  for (std::size_t line = 0; line < markings.size(); ++line) {
    const auto& pieces = markings[line].pieces;
    for (std::size_t piece = 0; piece < pieces.size(); ++piece) {
      for (const Eigen::Vector2d& p : pieces[piece].centre) {
        const float z = ground.height_at(static_cast<float>(p.x()), static_cast<float>(p.y()));
        text += fmt::format("{},{},{},{:.3f},{:.4f},{:.4f},{:.4f}\n", line, piece, paint::name_of(markings[line].type),
                            pieces[piece].width, p.x(), p.y(), z);
      }
    }
  }
  write_file(folder, "markings.csv", text);
}

}  // namespace

void prepare_truth_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const std::string probe = folder + "/.writable";
  std::ofstream out(probe);
  if (error || !out) {
    throw std::runtime_error(
        fmt::format("truth folder {} cannot be written: {}", folder, error ? error.message() : "no permission"));
  }
  out.close();
  std::filesystem::remove(probe, error);
}

ClassImageInfo write_town_truth(const std::string& folder, const world::Town& town,
                                std::span<const paint::Marking> markings, double vehicle_height) {
  const ClassGrid grid = make_class_grid(*town.scene, vehicle_height);
  write_png(folder + "/classes.png", grid.image);
  const std::string fine_file = folder + "/fine_classes.png";
  const double fine = fine_resolution(*town.scene);
  const bool has_fine = fine < grid.resolution;
  if (has_fine)
    write_png(fine_file, make_class_grid(*town.scene, vehicle_height, fine).image);
  else
    std::filesystem::remove(fine_file);  // of a smaller town written here before
  std::string text = "line,x,y,z,height,dropped\n";
  int line = 0;
  for (const auto& curb : trace_curbs(town.scene->ground())) {
    for (const auto& point : curb) {
      text += fmt::format("{},{:.4f},{:.4f},{:.4f},{:.4f},{}\n", line, point.foot.x(), point.foot.y(), point.foot.z(),
                          point.height, point.dropped ? 1 : 0);
    }
    ++line;
  }
  write_file(folder, "curbs.csv", text);
  write_markings(folder, town.scene->ground(), markings);
  return {grid.resolution, grid.x0, grid.y0, grid.image.width, grid.image.height, has_fine ? fine : 0};
}

void write_drive_truth(const std::string& folder, const TruthInfo& info, const motion::Motion& motion,
                       const std::optional<ClassImageInfo>& classes) {
  write_poses(folder, info, motion);
  nlohmann::ordered_json json = {
      {"start_utime", info.start_utime}, {"seed", info.seed}, {"source", info.source}, {"seconds", info.seconds}};
  if (info.latest_packet) json["latest_packet_s"] = *info.latest_packet;
  if (classes) {
    json["resolution_m"] = classes->resolution;
    json["origin"] = {classes->x0, classes->y0};
    json["width"] = classes->width;
    json["height"] = classes->height;
    if (classes->fine_resolution > 0) json["fine_resolution_m"] = classes->fine_resolution;
  } else {
    json["classes"] = nullptr;
  }
  write_file(folder, "truth.json", json_text(json, 2) + "\n");
}

}  // namespace curbstone::simulate::truth
