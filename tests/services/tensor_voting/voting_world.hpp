#pragma once

#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/tile_index_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <curbstone/voted_points_t.hpp>
#include <map>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/tile_sync/tile_sync.hpp"
#include "tests/services/tensor_voting/clouds.hpp"

namespace curbstone::test_world {

using test_clouds::Tiles;

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
  FakeMapper(LocalBus& bus, Publisher& publisher, test_clouds::Tiles tiles)
      : publisher_(publisher), tiles_(std::move(tiles)), catalog_("mapper", "MAP_POINTS") {
    catalog_.start_epoch(epoch_);
    bus.subscribe<tile_request_t>("TILE_REQUEST", [this](const tile_request_t& m) { catalog_.request(m); });
  }
  void start_epoch(std::int32_t epoch, test_clouds::Tiles tiles) {
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
    pose.map_base_position[0] = vehicle_x;
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
  [[nodiscard]] const test_clouds::Tiles& tiles() const { return tiles_; }
  double vehicle_x = 0;  ///< m, said with the points
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
  test_clouds::Tiles tiles_;
  std::map<TileKey, std::size_t> done_;
  TileCatalog catalog_;
  std::int32_t epoch_ = 1;
  std::int64_t last_index_ = 0;
};

/// A tile as the steps of VOTED_POINTS make it: one page with everything, as if it had come at once.
class VotedTileRecord {
 public:
  voted_points_t all{};  ///< voters and tensors are put in by finished()

  [[nodiscard]] bool goes_on(const std::map<std::int32_t, voted_points_t>& step) const {
    const voted_points_t& head = step.begin()->second;
    return head.base == 0 || (all.chain == head.chain && all.revision >= head.base);
  }
  void take(const std::map<std::int32_t, voted_points_t>& step) {
    const voted_points_t& head = step.begin()->second;
    if (head.base == 0) *this = {};
    for (const auto& [number, page] : step) append(page);
    all.utime = head.utime;
    all.epoch = head.epoch;
    all.tile_x = head.tile_x;
    all.tile_y = head.tile_y;
    all.z_origin = head.z_origin;
    all.chain = head.chain;
    all.revision = head.revision;
    all.total = head.total;
    all.num_scales = head.num_scales;
    all.sigma = head.sigma;
  }
  /// Says nothing of when and in which steps it came.
  [[nodiscard]] voted_points_t finished() const {
    voted_points_t m = all;
    m.utime = m.chain = 0;
    m.num_pages = 1;
    m.num_points = static_cast<std::int32_t>(m.x.size());
    for (const auto& voters : voters_) m.voter.insert(m.voter.end(), voters.begin(), voters.end());
    m.num_voters = static_cast<std::int32_t>(m.voter.size());
    for (const auto& [place, from] : tensors_) append_tensor(from.first, from.second, m);
    m.num_tensors = static_cast<std::int32_t>(m.point.size());
    return m;
  }

 private:
  static void append_tensor(const voted_points_t& page, std::size_t i, voted_points_t& m) {
    m.scale.push_back(page.scale[i]);
    m.point.push_back(page.point[i]);
    m.normal_x.push_back(page.normal_x[i]);
    m.normal_y.push_back(page.normal_y[i]);
    m.normal_z.push_back(page.normal_z[i]);
    m.tangent_x.push_back(page.tangent_x[i]);
    m.tangent_y.push_back(page.tangent_y[i]);
    m.tangent_z.push_back(page.tangent_z[i]);
    m.stick.push_back(page.stick[i]);
    m.plate.push_back(page.plate[i]);
    m.mass.push_back(page.mass[i]);
  }
  void append(const voted_points_t& page) {
    voters_.resize(static_cast<std::size_t>(page.num_scales));
    const auto count = static_cast<std::size_t>(page.num_points);
    const auto known = all.x.size();
    const auto first = static_cast<std::size_t>(page.first);
    for (std::size_t i = known - std::min(known, first); i < count; ++i) {
      all.x.push_back(page.x[i]);
      all.y.push_back(page.y[i]);
      all.z.push_back(page.z[i]);
      all.intensity.push_back(page.intensity[i]);
      for (std::size_t s = 0; s < voters_.size(); ++s) voters_[s].push_back(page.voter[s * count + i]);
    }
    for (std::size_t i = 0; i < page.point.size(); ++i) {
      voted_points_t one{};
      append_tensor(page, i, one);
      tensors_[{page.scale[i], page.point[i]}] = {std::move(one), 0};
    }
  }

  std::vector<std::vector<std::int32_t>> voters_;  // by scale
  std::map<std::pair<int, std::int32_t>, std::pair<voted_points_t, std::size_t>> tensors_;
};

/// Listens as semantic_map does: follows the steps, asks for what it lacks.
class Listener {
 public:
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
  /// The newest complete revision of each tile, as bytes.
  [[nodiscard]] std::map<TileKey, std::vector<std::uint8_t>> contents() const {
    std::map<TileKey, std::vector<std::uint8_t>> result;
    for (const auto& [key, tile] : complete_) {
      const voted_points_t all = tile.finished();
      std::vector<std::uint8_t>& bytes = result[key];
      bytes.resize(static_cast<std::size_t>(all.getEncodedSize()));
      all.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    }
    return result;
  }
  [[nodiscard]] const std::map<TileKey, VotedTileRecord>& tiles() const { return complete_; }
  std::map<std::string, int> indexes;  // heard, by owner
  int messages = 0;
  int gaps = 0;  // steps that went on from what it did not have

 private:
  void on(const voted_points_t& message) {
    ++messages;
    if (message.epoch != epoch_) return;
    const TileKey key{message.tile_x, message.tile_y};
    VotedTileRecord& tile = complete_[key];
    if (message.revision <= tile.all.revision) return;
    auto& step = partial_[key];
    if (!step.empty()) {
      const voted_points_t& other = step.begin()->second;
      if (message.revision < other.revision) return;
      if (std::tie(message.revision, message.base, message.chain) != std::tie(other.revision, other.base, other.chain))
        step.clear();
    }
    step[message.page] = message;
    if (static_cast<std::int32_t>(step.size()) < message.num_pages) return;
    if (tile.goes_on(step)) {
      tile.take(step);
      follower_.set_have(key, message.revision);
    } else {
      ++gaps;
      follower_.lacks(key, message.revision);
    }
    step.clear();
  }

  Publisher& publisher_;
  std::int32_t epoch_ = 1;
  TileFollower follower_;
  std::map<TileKey, std::map<std::int32_t, voted_points_t>> partial_;  // pages of a step
  std::map<TileKey, VotedTileRecord> complete_;
};

}  // namespace curbstone::test_world
