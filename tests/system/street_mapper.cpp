#include "tests/system/street_mapper.hpp"

#include <algorithm>
#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>

namespace curbstone::system_test {

namespace {
constexpr std::int64_t kScan = 100'000;           // us
constexpr std::int64_t kIndexPeriod = 1'000'000;  // us
constexpr std::size_t kPointsPerScan = 2500;
constexpr std::size_t kPointsPerMessage = 3000;
constexpr std::size_t kRequestsPerTick = 2;  // tiles
constexpr double kSpeed = 3.0;               // m/s
}  // namespace

StreetMapper::StreetMapper(Subscriber& bus, Publisher& publisher) : publisher_(publisher) {
  catalog_.start_epoch(kEpoch);
  bus.subscribe<tile_request_t>("TILE_REQUEST", [this](const tile_request_t& m) { catalog_.request(m); });
}

void StreetMapper::map_scan(std::int64_t now) {
  x_ += kSpeed * static_cast<double>(kScan) * 1e-6;
  std::vector<Eigen::Vector3d> points = test_clouds::street(kPointsPerScan, ++scan_);
  for (Eigen::Vector3d& p : points) p.x() += x_;
  for (const auto& [key, fresh] : test_clouds::as_tiles(points)) {
    std::vector<TilePoint>& tile = tiles_[key];
    const std::size_t before = tile.size();
    tile.insert(tile.end(), fresh.begin(), fresh.end());
    send(now, key, before);
    catalog_.set_version(key, static_cast<std::int32_t>(tile.size()));
  }
  map_pose_t pose{};
  pose.utime = now;
  pose.epoch = kEpoch;
  pose.map_base_position[0] = x_;
  publisher_.publish("MAP_POSE", pose);
}

void StreetMapper::send(std::int64_t now, TileKey key, std::size_t first) {
  const std::vector<TilePoint>& tile = tiles_.at(key);
  for (; first < tile.size(); first += kPointsPerMessage) {
    const std::size_t last = std::min(tile.size(), first + kPointsPerMessage);
    map_points_t message{};
    message.utime = now;
    message.epoch = kEpoch;
    message.tile_x = key.x;
    message.tile_y = key.y;
    message.first = static_cast<std::int32_t>(first);
    message.num_points = static_cast<std::int32_t>(last - first);
    for (std::size_t i = first; i < last; ++i) {
      message.x.push_back(tile[i].x);
      message.y.push_back(tile[i].y);
      message.z.push_back(tile[i].z);
      message.intensity.push_back(tile[i].intensity);
    }
    publisher_.publish("MAP_POINTS", message);
  }
}

void StreetMapper::tick(std::int64_t now, bool driving) {
  if (driving && now - last_scan_ >= kScan) {
    last_scan_ = now;
    map_scan(now);
  }
  for (const auto& [key, have] : catalog_.take_requests(kRequestsPerTick)) {
    send(now, key, static_cast<std::size_t>(std::max(have, 0)));
  }
  if (now - last_index_ < kIndexPeriod) return;
  last_index_ = now;
  for (const tile_index_t& page : catalog_.make_index(now, x_, 0)) publisher_.publish("TILE_INDEX", page);
}

}  // namespace curbstone::system_test
