#include "tools/view/saved_map.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

#include "services/semantic_map/semantic_messages.hpp"
#include "services/semantic_map/store/map_store.hpp"

namespace curbstone::view {
namespace {

using semantic_map::store::MapReader;

constexpr float kAll = 1e6F;  // m, half size of a box around everything
constexpr std::string_view kSqlite = "SQLite format 3";

/// The whole drive in one page, because it is not sent over a bus.
map_trajectory_t trajectory_of(const MapReader& file, std::int32_t epoch) {
  map_trajectory_t message{};
  message.epoch = epoch;
  message.num_pages = 1;
  for (const auto& pose : file.trajectory()) {
    const Eigen::Vector3f place = pose.T_map_base.translation().cast<float>();
    message.utime = pose.utime;
    message.utimes.push_back(pose.utime);
    message.positions.push_back({place.x(), place.y(), place.z()});
  }
  message.num_poses = static_cast<std::int32_t>(message.utimes.size());
  return message;
}

curb_lines_t curbs_of(const MapReader& file, const map_trajectory_t& trajectory) {
  curb_lines_t message{};
  message.utime = trajectory.utime;
  message.epoch = trajectory.epoch;
  std::fill(std::begin(message.box_min), std::end(message.box_min), -kAll);
  std::fill(std::begin(message.box_max), std::end(message.box_max), kAll);
  std::vector<Eigen::Vector2d> path;
  path.reserve(trajectory.positions.size());
  for (const auto& place : trajectory.positions) path.emplace_back(place[0], place[1]);
  for (const auto& line : file.curbs()) message.lines.push_back(semantic_map::to_message(line, path));
  message.num_lines = static_cast<std::int32_t>(message.lines.size());
  return message;
}

marking_lines_t markings_of(const MapReader& file, const map_trajectory_t& trajectory) {
  marking_lines_t message{};
  message.utime = trajectory.utime;
  message.epoch = trajectory.epoch;
  std::fill(std::begin(message.box_min), std::end(message.box_min), -kAll);
  std::fill(std::begin(message.box_max), std::end(message.box_max), kAll);
  for (const auto& line : file.markings()) message.lines.push_back(semantic_map::to_message(line));
  message.num_lines = static_cast<std::int32_t>(message.lines.size());
  return message;
}

}  // namespace

bool is_map_file(const std::string& file) {
  if (std::filesystem::is_directory(file)) return false;  // a session's folder of logs
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file + ": " + std::generic_category().message(errno));
  std::array<char, kSqlite.size()> head{};
  in.read(head.data(), head.size());
  return std::string_view(head.data(), static_cast<std::size_t>(in.gcount())) == kSqlite;
}

void show_saved_map(const std::string& file, std::int64_t now, viewer::ViewerNode& node) {
  const MapReader reader(file);
  // A node ignores an epoch ahead of the clock; there is no other epoch here.
  const auto epoch = static_cast<std::int32_t>(std::min<std::int64_t>(reader.epoch(), now / 1'000'000));
  const map_trajectory_t trajectory = trajectory_of(reader, epoch);
  node.on(trajectory);
  for (const auto& tile : reader.tiles()) node.on(semantic_map::to_message(tile, epoch, 1));
  node.on(curbs_of(reader, trajectory));
  node.on(markings_of(reader, trajectory));
}

}  // namespace curbstone::view
