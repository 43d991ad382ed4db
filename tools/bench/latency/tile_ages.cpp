#include "tools/bench/latency/tile_ages.hpp"

#include <algorithm>
#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/semantic_tile_t.hpp>
#include <curbstone/voted_points_t.hpp>

namespace curbstone::bench::latency {

namespace {

AgeFigures figures(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double q) {
    return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
  };
  return {values.size(), at(0.5), at(0.95), values.back()};
}

}  // namespace

void TileAges::on_message(const TimedMessage& message) {
  channels_[message.channel].bytes += message.bytes->size();
  if (message.channel == "MAP_POSE") {
    map_pose_t m;
    if (message.decode(m)) sent_tile(message.channel, {}, m.utime, message.at);
  } else if (message.channel == "MAP_POINTS") {
    map_points_t m;
    if (!message.decode(m)) return;
    follow_epoch(m.epoch, message.at);
    sent_tile(message.channel, {m.tile_x, m.tile_y}, m.utime, message.at);
    if (m.utime <= epoch_began_) return;
    for (News* news : {&tiles_, &curbs_}) news->waiting[{m.tile_x, m.tile_y}].push_back(m.utime);
  } else if (message.channel == "VOTED_POINTS") {
    voted_points_t m;
    if (message.decode(m) && m.page + 1 == m.num_pages)
      sent_tile(message.channel, {m.tile_x, m.tile_y}, m.utime, message.at);
  } else if (message.channel == "SEMANTIC_TILE") {
    semantic_tile_t m;
    if (!message.decode(m)) return;
    sent_tile(message.channel, {m.tile_x, m.tile_y}, m.utime, message.at);
    tiles_.out({m.tile_x, m.tile_y}, m.utime, message.at);
    const std::vector<Measured> known = curbs_.out({m.tile_x, m.tile_y}, m.curbs_utime, message.at);
    unsaid_.insert(unsaid_.end(), known.begin(), known.end());
  } else if (message.channel == "CURBS") {
    curb_lines_t m;
    if (message.decode(m)) say_lines(m, message.at);
  }
}

TileAges TileAges::next_part() const {
  TileAges next;
  next.epoch_ = epoch_;
  next.epoch_began_ = epoch_began_;
  return next;
}

/// A new epoch sends the whole map again, which MAP_POINTS are the first to say.
void TileAges::follow_epoch(std::int32_t epoch, std::int64_t at) {
  if (epoch_ && epoch <= *epoch_) return;
  if (epoch_) epoch_began_ = at;
  epoch_ = epoch;
  for (News* news : {&tiles_, &curbs_}) news->waiting.clear();
  unsaid_.clear();
}

std::vector<TileAges::Measured> TileAges::News::out(TileKey key, std::int64_t utime, std::int64_t at) {
  std::vector<Measured> known;
  std::erase_if(waiting[key], [&](std::int64_t measured) {
    if (measured > utime) return false;
    ages.push_back(static_cast<double>(at - measured) * 1e-3);
    known.push_back({key, measured});
    return true;
  });
  return known;
}

/// A tile counts if its centre is in the box.
void TileAges::say_lines(const curb_lines_t& message, std::int64_t at) {
  for (const Measured& m : unsaid_) {
    const double middle[2] = {(m.key.x + 0.5) * kTileSize, (m.key.y + 0.5) * kTileSize};
    const auto is_in = [&](int axis) {
      return middle[axis] >= double{message.box_min[axis]} && middle[axis] <= double{message.box_max[axis]};
    };
    if (is_in(0) && is_in(1)) said_ages_.push_back(static_cast<double>(at - m.utime) * 1e-3);
  }
  unsaid_.clear();
}

void TileAges::sent_tile(const std::string& channel, TileKey key, std::int64_t utime, std::int64_t at) {
  Channel& c = channels_[channel];
  ++c.sent;
  std::int64_t& newest = c.newest[key];
  if (utime <= std::max(newest, epoch_began_)) return;
  newest = utime;
  c.ages.push_back(static_cast<double>(at - utime) * 1e-3);
}

AgeFigures TileAges::age(const std::string& channel) const {
  const auto it = channels_.find(channel);
  return it == channels_.end() ? AgeFigures{} : figures(it->second.ages);
}

AgeFigures TileAges::news() const {
  return figures(tiles_.ages);
}

AgeFigures TileAges::curb_news() const {
  return figures(curbs_.ages);
}

AgeFigures TileAges::line_news() const {
  return figures(said_ages_);
}

std::size_t TileAges::sent(const std::string& channel) const {
  const auto it = channels_.find(channel);
  return it == channels_.end() ? 0 : it->second.sent;
}

double TileAges::megabytes(const std::string& channel) const {
  const auto it = channels_.find(channel);
  return it == channels_.end() ? 0 : static_cast<double>(it->second.bytes) * 1e-6;
}

}  // namespace curbstone::bench::latency
