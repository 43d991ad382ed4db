#include "services/viewer/frames/cloud_feed.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <vector>

namespace curbstone::viewer::frames {
namespace {

using store::DenseCloud;

void write_point(ByteWriter& out, const DenseCloud::Point& point) {
  out.i16(point.x);
  out.i16(point.y);
  out.i16(point.z);
  out.u8(point.intensity);
  out.u8(point.surface);
  out.u8(point.line);
}

/// The points that changed after `number`, in runs.
void write_tile(ByteWriter& out, TileKey key, const DenseCloud::Tile& tile, std::uint64_t number) {
  std::vector<std::pair<std::size_t, std::size_t>> runs;  // first, end
  for (std::size_t i = 0; i < tile.slots.size(); ++i) {
    if (tile.slots[i].number <= number) continue;
    if (runs.empty() || runs.back().second != i) runs.emplace_back(i, i);
    runs.back().second = i + 1;
  }
  out.i32(key.x);
  out.i32(key.y);
  out.f32(tile.z_origin);
  out.u16(static_cast<std::uint16_t>(tile.slots.size()));
  out.u16(static_cast<std::uint16_t>(runs.size()));
  for (const auto& [first, end] : runs) {
    out.u16(static_cast<std::uint16_t>(first));
    out.u16(static_cast<std::uint16_t>(end - first));
    for (std::size_t i = first; i < end; ++i) write_point(out, tile.slots[i].point);
  }
}

}  // namespace

void CloudFeed::want(const CloudWish& wish) {
  if (!wish.wide || !wish_.wide) forget();  // the page keeps the cloud only while it shows it
  wish_ = wish;
}

bool CloudFeed::is_cut(TileKey key) const {
  constexpr double kSquared = DenseCloud::kCutReach * DenseCloud::kCutReach;
  return wish_.cut && squared_distance(key, wish_.cut->first, wish_.cut->second) <= kSquared;
}

std::uint64_t CloudFeed::sent(TileKey key) const {
  const auto it = sent_.find(key);
  return it == sent_.end() ? 0 : it->second;
}

bool CloudFeed::has_news(const DenseCloud& cloud) const {
  if (!wish_.any()) return false;
  return std::any_of(cloud.tiles().begin(), cloud.tiles().end(), [&](const auto& entry) {
    return entry.second.number > sent(entry.first) && (wish_.wide || is_cut(entry.first));
  });
}

bool CloudFeed::write(ByteWriter& out, const DenseCloud& cloud, std::int64_t now) {
  const double passed = last_ == 0 ? 0 : static_cast<double>(std::max<std::int64_t>(0, now - last_)) * 1e-6;
  last_ = now;
  allowance_ = std::min(kMaxBytes, allowance_ + kRate * passed);
  std::erase_if(sent_, [&](const auto& entry) { return !cloud.tiles().contains(entry.first); });

  struct Due {
    std::tuple<bool, std::ptrdiff_t, double> turn;
    TileKey key;
    const DenseCloud::Tile* tile;
  };
  std::vector<Due> due;
  for (const auto& [key, tile] : cloud.tiles()) {
    const bool cut = is_cut(key);
    if (tile.number <= sent(key) || (!wish_.wide && !cut)) continue;
    const auto& places = cloud.places();
    const double away = places.empty() ? 0 : squared_distance(key, places.front().x, places.front().y);
    const std::uint64_t number = sent(key);
    const auto news = std::count_if(tile.slots.begin(), tile.slots.end(),
                                    [number](const DenseCloud::Slot& slot) { return slot.number > number; });
    due.push_back({{!cut, -news, away}, key, &tile});
  }
  std::sort(due.begin(), due.end(), [](const Due& a, const Due& b) { return a.turn < b.turn; });
  const std::size_t begin = out.size();
  for (const Due& next : due) {
    const std::size_t before = out.size();
    if (allowance_ <= 0) break;
    write_tile(out, next.key, *next.tile, sent(next.key));
    sent_[next.key] = next.tile->number;
    allowance_ -= static_cast<double>(out.size() - before);
  }
  return out.size() > begin;
}

}  // namespace curbstone::viewer::frames
