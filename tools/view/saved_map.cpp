#include "tools/view/saved_map.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "services/semantic_map/semantic_messages.hpp"

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

ShownMap::ShownMap(std::string file, std::string title, viewer::ViewerNode& node)
    : file_(std::move(file)), title_(std::move(title)), node_(node) {}

ShownMap::Mark ShownMap::mark() const {
  Mark mark;
  for (std::size_t i = 0; i < 2; ++i) {
    struct stat found {};
    if (stat((file_ + (i == 0 ? "" : "-wal")).c_str(), &found) != 0) continue;
    mark.inode[i] = found.st_ino;
    mark.size[i] = found.st_size;
    mark.changed[i] = found.st_mtim.tv_sec * 1'000'000'000 + found.st_mtim.tv_nsec;
  }
  return mark;
}

void ShownMap::show(std::int64_t now) {
  const Mark now_is = mark();
  const MapReader reader(file_);
  // A node ignores an epoch ahead of the clock; there is no other epoch here.
  const auto epoch = static_cast<std::int32_t>(std::min<std::int64_t>(reader.epoch(), now / 1'000'000));
  if (epoch_ && (*epoch_ != epoch || shown_as_.inode[0] != now_is.inode[0])) {
    node_.restart();
    passed_on_.clear();
  }
  epoch_ = epoch;
  pass_on(reader);
  shown_as_ = now_is;
  node_.set_title(title_);
}

void ShownMap::pass_on(const MapReader& reader) {
  ++revision_;
  const map_trajectory_t trajectory = trajectory_of(reader, *epoch_);
  node_.on(trajectory);
  std::vector<char> bytes;
  for (const auto& tile : reader.tiles()) {
    semantic_tile_t message = semantic_map::to_message(tile, *epoch_, 0);
    bytes.resize(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    const std::size_t hash = std::hash<std::string_view>{}({bytes.data(), bytes.size()});
    const auto [place, is_new] = passed_on_.try_emplace(tile.key, hash);
    if (!is_new && std::exchange(place->second, hash) == hash) continue;
    message.revision = revision_;
    node_.on(message);
  }
  node_.on(curbs_of(reader, trajectory));
  node_.on(markings_of(reader, trajectory));
}

void ShownMap::look(std::int64_t now) {
  const Mark now_is = mark();
  if (now_is == shown_as_) return;
  if (now_is.inode[0] == 0) return node_.set_title(title_ + " (deleted)");
  try {
    show(now);
  } catch (const std::exception&) {  // it is being written, say: the next call tries again
    node_.set_title(title_ + " (cannot be read now)");
  }
}

}  // namespace curbstone::view
