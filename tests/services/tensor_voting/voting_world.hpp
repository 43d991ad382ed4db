#pragma once

#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/tile_index_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <curbstone/voted_points_t.hpp>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "common/local_bus.hpp"
#include "common/tile_sync.hpp"
#include "tests/services/tensor_voting/clouds.hpp"

namespace curbstone::testing_world {

using testing_clouds::Tiles;

/// Between a node and the bus: loses, doubles and delays messages, by a seed.
class LossyPublisher final : public Publisher {
 public:
  LossyPublisher(LocalBus& bus, double trouble, unsigned seed) : bus_(bus), trouble_(trouble), random_(seed) {}
  void heal() {
    trouble_ = 0;
    for (const auto& [channel, bytes] : late_) bus_.inject(channel, bytes.data(), static_cast<int>(bytes.size()));
    late_.clear();
  }

 protected:
  void publish_bytes(const std::string& channel, const void* data, int size) override {
    std::uniform_real_distribution<double> unit(0, 1);
    const double fate = unit(random_) / (trouble_ > 0 ? trouble_ : 1e-9);
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    if (fate < 0.5) return;
    if (fate < 0.75) late_.push_back({channel, {bytes, bytes + size}});
    if (fate >= 0.75) bus_.inject(channel, data, size);
    if (fate >= 0.75 && fate < 1) bus_.inject(channel, data, size);
    if (late_.size() > 5) {
      const auto [late_channel, late_bytes] = late_.front();
      late_.erase(late_.begin());
      bus_.inject(late_channel, late_bytes.data(), static_cast<int>(late_bytes.size()));
    }
  }

 private:
  LocalBus& bus_;
  double trouble_;
  std::mt19937 random_;
  std::vector<std::pair<std::string, std::vector<std::uint8_t>>> late_;
};

/// Publishes a cloud tile by tile as the mapper would, announces it, and answers requests.
class FakeMapper {
 public:
  FakeMapper(LocalBus& bus, Publisher& publisher, Tiles tiles)
      : publisher_(publisher), tiles_(std::move(tiles)), catalog_("mapper", "MAP_POINTS") {
    catalog_.start_epoch(epoch_);
    bus.subscribe<tile_request_t>("TILE_REQUEST", [this](const tile_request_t& m) { catalog_.request(m); });
  }
  void start_epoch(std::int32_t epoch, Tiles tiles) {
    epoch_ = epoch;
    tiles_ = std::move(tiles);
    done_.clear();
    catalog_.start_epoch(epoch);
  }
  /// Adds `share` of each tile's points to the map.
  void map(std::int64_t now, double share) {
    for (const auto& [key, points] : tiles_) {
      const auto until = std::min(
          points.size(), done_[key] + static_cast<std::size_t>(share * static_cast<double>(points.size())) + 1);
      send(now, key, done_[key], until);
      done_[key] = until;
      catalog_.set_version(key, static_cast<std::int32_t>(until));
    }
    map_pose_t pose{};
    pose.utime = now;
    pose.epoch = epoch_;
    publisher_.publish("MAP_POSE", pose);
  }
  void tick(std::int64_t now) {
    for (const auto& wanted : catalog_.take_requests(50)) {
      send(now, wanted.key, static_cast<std::size_t>(wanted.have), done_[wanted.key]);
    }
    if (now - last_index_ < 1'000'000) return;
    last_index_ = now;
    for (const auto& page : catalog_.make_index(now, 0, 0)) publisher_.publish("TILE_INDEX", page);
  }
  [[nodiscard]] const Tiles& tiles() const { return tiles_; }
  /// Points so far.
  [[nodiscard]] std::size_t mapped() const {
    std::size_t total = 0;
    for (const auto& [key, count] : done_) total += count;
    return total;
  }

 private:
  void send(std::int64_t now, TileKey key, std::size_t from, std::size_t until) {
    for (; from < until; from += 500) {
      map_points_t message{};
      message.utime = now;
      message.epoch = epoch_;
      message.tile_x = key.x;
      message.tile_y = key.y;
      message.first = static_cast<std::int32_t>(from);
      message.num_points = static_cast<std::int32_t>(std::min<std::size_t>(500, until - from));
      for (std::size_t i = from; i < std::min(until, from + 500); ++i) {
        const TilePoint& p = tiles_.at(key)[i];
        message.x.push_back(p.x);
        message.y.push_back(p.y);
        message.z.push_back(p.z);
        message.intensity.push_back(p.intensity);
      }
      publisher_.publish("MAP_POINTS", message);
    }
  }

  Publisher& publisher_;
  Tiles tiles_;
  std::map<TileKey, std::size_t> done_;
  TileCatalog catalog_;
  std::int32_t epoch_ = 1;
  std::int64_t last_index_ = 0;
};

/// Listens as semantic_map does: assembles revisions, asks for what it lacks.
class Listener {
 public:
  struct Tile {
    std::int32_t revision = 0;
    std::map<std::int32_t, voted_points_t> pages;
    [[nodiscard]] bool complete() const {
      std::int32_t points = 0;
      for (const auto& [first, page] : pages) points += page.num_points;
      return !pages.empty() && points == pages.begin()->second.total;
    }
  };

  Listener(Subscriber& bus, Publisher& publisher) : publisher_(publisher), follower_("listener", "VOTED_POINTS") {
    follower_.start_epoch(1);
    bus.subscribe<voted_points_t>("VOTED_POINTS", [this](const voted_points_t& m) { on(m); });
    bus.subscribe<tile_index_t>("TILE_INDEX", [this](const tile_index_t& m) {
      if (m.channel == "VOTED_POINTS") ++indexes[m.owner];
      (void)follower_.announced(m);
    });
  }
  void tick(std::int64_t now) {
    const tile_request_t request = follower_.make_request(now);
    if (request.num_tiles > 0) publisher_.publish("TILE_REQUEST", request);
  }
  void start_epoch(std::int32_t epoch) {
    epoch_ = epoch;
    complete_.clear();
    partial_.clear();
    follower_.start_epoch(epoch);
  }
  /// The newest complete revision of each tile, as bytes; utime, which says when and not what, set to 0.
  [[nodiscard]] std::map<TileKey, std::vector<std::vector<std::uint8_t>>> contents() const {
    std::map<TileKey, std::vector<std::vector<std::uint8_t>>> result;
    for (const auto& [key, tile] : complete_) {
      for (const auto& [first, page] : tile.pages) {
        voted_points_t timeless = page;
        timeless.utime = 0;
        std::vector<std::uint8_t> bytes(static_cast<std::size_t>(timeless.getEncodedSize()));
        timeless.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
        result[key].push_back(std::move(bytes));
      }
    }
    return result;
  }
  [[nodiscard]] const std::map<TileKey, Tile>& tiles() const { return complete_; }
  std::map<std::string, int> indexes;  // heard, by owner
  int messages = 0;

 private:
  void on(const voted_points_t& message) {
    ++messages;
    if (message.epoch != epoch_) return;
    const TileKey key{message.tile_x, message.tile_y};
    Tile& tile = partial_[key];
    if (message.revision < tile.revision) return;
    if (message.revision > tile.revision) tile = {message.revision, {}};
    tile.pages[message.first] = message;
    if (!tile.complete()) return;
    complete_[key] = tile;
    follower_.set_have(key, tile.revision);
  }

  Publisher& publisher_;
  std::int32_t epoch_ = 1;
  TileFollower follower_;
  std::map<TileKey, Tile> partial_;
  std::map<TileKey, Tile> complete_;
};

}  // namespace curbstone::testing_world
