#include "services/viewer/foxglove/feed.hpp"

#include <cstdlib>

#include "services/viewer/foxglove/grid_message.hpp"
#include "services/viewer/foxglove/point_message.hpp"
#include "services/viewer/foxglove/pose_messages.hpp"
#include "services/viewer/foxglove/scene_messages.hpp"

namespace curbstone::viewer::foxglove {
namespace {

// us, minimum period of a topic
constexpr std::int64_t kAtOnce = 0;
constexpr std::int64_t kScanPeriod = 100'000;
constexpr std::int64_t kWindowPeriod = 500'000;
constexpr std::int64_t kLinePeriod = 500'000;
constexpr std::int64_t kPointsPeriod = 2'000'000;
constexpr std::int64_t kWholePeriod = 10'000'000;

TileKey vehicle_tile(const World& world) {
  if (!world.pose) return {};
  return tile_at(world.pose->map_base_position[0], world.pose->map_base_position[1]).value_or(TileKey{});
}

}  // namespace

std::vector<Message> Feed::due(const World& world, std::int64_t now, bool takes_large) {
  Sink out;
  send_pose(world, now, out);
  send_status(world, now, out);
  send_log(world, now, out);
  send_lines(kCurbs, world.map.curbs, curbs_message, world.map.newest_utime, now, out);
  send_lines(kMarkings, world.map.markings, markings_message, world.map.newest_utime, now, out);
  send_path(world, now, out);
  if (takes_large) {
    // The rarest first: otherwise the frequent ones would always be sent instead.
    (void)(send_map(world, now, out) || send_points(world, now, out) || send_window(world, now, out) ||
           send_scan(world, now, out));
  }
  return out;
}

Feed::Sent* Feed::ready(std::uint32_t channel, std::int64_t now, std::int64_t period) {
  const auto found = sent_.find(channel);
  if (found == sent_.end() || (found->second.at && std::abs(now - *found->second.at) < period)) return nullptr;
  return &found->second;
}

bool Feed::is_whole_due(const Sent& sent, std::int64_t now) const {
  return !sent.whole || (listener_ == For::kFile && std::abs(now - *sent.whole) >= kWholePeriod);
}

void Feed::send_pose(const World& world, std::int64_t now, Sink& out) {
  if (!world.pose) return;
  const map_pose_t& pose = *world.pose;
  const auto number = static_cast<std::uint64_t>(pose.utime);
  for (const Topic topic : {kTransforms, kPose}) {
    Sent* sent = ready(topic, now, kAtOnce);
    if (sent == nullptr || sent->number == number) continue;
    out.push_back({topic, pose.utime, topic == kPose ? pose_message(pose) : transforms_message(pose, world.vehicle)});
    sent->at = now;
    sent->number = number;
  }
}

void Feed::send_status(const World& world, std::int64_t now, Sink& out) {
  const auto& services = world.status.services();
  for (std::size_t i = 0; i < services.size(); ++i) {
    const auto channel = static_cast<std::uint32_t>(kFirstStatus + i);
    Sent* sent = ready(channel, now, kAtOnce);
    if (sent == nullptr || sent->number == services[i].number) continue;
    out.push_back({channel, services[i].utime, services[i].json});
    sent->at = now;
    sent->number = services[i].number;
  }
}

void Feed::send_log(const World& world, std::int64_t now, Sink& out) {
  Sent* sent = ready(kLog, now, kAtOnce);
  if (sent == nullptr) return;
  for (const auto& line : world.status.lines()) {
    if (line.number <= sent->number) continue;
    out.push_back({kLog, line.utime, log_message(line)});
    sent->number = line.number;
  }
}

template <class Lines, class Message>
void Feed::send_lines(Topic topic, const Lines& lines, const Message& message_of, std::int64_t utime, std::int64_t now,
                      Sink& out) {
  Sent* sent = ready(topic, now, kLinePeriod);
  if (sent == nullptr) return;
  const bool whole = is_whole_due(*sent, now);
  if (!whole && sent->number == lines.number()) return;
  const auto changes = lines.above(whole ? 0 : static_cast<std::uint32_t>(sent->number));
  out.push_back({topic, utime, message_of(changes, utime)});
  if (whole) sent->whole = now;
  sent->at = now;
  sent->number = changes.number;
}

void Feed::send_path(const World& world, std::int64_t now, Sink& out) {
  Sent* sent = ready(kPath, now, kLinePeriod);
  if (sent == nullptr) return;
  const auto& path = world.map.path;
  const bool whole = is_whole_due(*sent, now) || sent->number != path.round();
  if (!whole && sent->points == path.points().size()) return;
  const std::int64_t utime = path.points().empty() ? 0 : path.points().back().utime;
  out.push_back({kPath, utime, path_message(path, sent->points, whole, utime)});
  if (whole) sent->whole = now;
  sent->at = now;
  sent->number = path.round();
  sent->points = path.points().size();
}

bool Feed::send_scan(const World& world, std::int64_t now, Sink& out) {
  Sent* sent = ready(kScan, now, kScanPeriod);
  if (sent == nullptr || sent->number == world.map.scan_number || world.map.scan.empty()) return false;
  const std::int64_t utime = world.pose ? world.pose->utime : now;
  out.push_back({kScan, utime, scan_message(world.map.scan, utime)});
  sent->at = now;
  sent->number = world.map.scan_number;
  return true;
}

bool Feed::send_points(const World& world, std::int64_t now, Sink& out) {
  Sent* sent = ready(kPoints, now, kPointsPeriod);
  if (sent == nullptr || sent->number == world.points.number()) return false;
  out.push_back({kPoints, world.points.utime(), point_message(world.points.points(), "map", world.points.utime())});
  sent->at = now;
  sent->number = world.points.number();
  return true;
}

bool Feed::send_window(const World& world, std::int64_t now, Sink& out) {
  Sent* sent = ready(kMapWindow, now, kWindowPeriod);
  const TileKey middle = vehicle_tile(world);
  if (sent == nullptr || world.map.map.number() == 0) return false;
  if (sent->at && sent->number == world.map.map.number() && sent->middle == middle) return false;
  const std::int64_t utime = world.map.newest_utime;
  out.push_back({kMapWindow, utime, window_grid(world.map.map, middle, utime)});
  sent->at = now;
  sent->number = world.map.map.number();
  sent->middle = middle;
  return true;
}

bool Feed::send_map(const World& world, std::int64_t now, Sink& out) {
  Sent* sent = ready(kMapWhole, now, kWholePeriod);
  if (sent == nullptr || sent->number == world.map.map.number()) return false;
  std::string grid = whole_grid(world.map.map, world.map.newest_utime);
  if (grid.empty()) return false;
  out.push_back({kMapWhole, world.map.newest_utime, std::move(grid)});
  sent->at = now;
  sent->number = world.map.map.number();
  return true;
}

}  // namespace curbstone::viewer::foxglove
