#include "services/viewer/cloud_intake.hpp"

#include <cmath>

#include "common/time/has_passed.hpp"

namespace curbstone::viewer {

using store::DenseCloud;

void CloudIntake::Wish::add(const frames::CloudWish& wish) {
  wide = wide || wish.wide;
  saliency = saliency || (wish.wide && wish.saliency);
  if (wish.cut) cuts.push_back(*wish.cut);
}

void CloudIntake::forget() {
  cloud_.clear();
  epoch_.reset();
}

void CloudIntake::tick(std::int64_t now, const Wish& wish, std::int32_t epoch, const std::optional<map_pose_t>& pose,
                       Subscriber* bus, Publisher& out) {
  if (is_wanted_ && !wish.any()) forget();
  is_wanted_ = wish.any();
  points_.tick(now, is_wanted_, bus);
  voted_.tick(now, wish.saliency, bus);
  if (!is_wanted_) return;
  if (has_saliency_ != wish.saliency) forget();
  has_saliency_ = wish.saliency;
  look(wish, epoch, pose);
  ask(now, wish, out);
}

/// Before the first pose only a cross-section says where.
void CloudIntake::look(const Wish& wish, std::int32_t epoch, const std::optional<map_pose_t>& pose) {
  if (epoch_ != epoch) {
    cloud_.clear();
    records_.start_epoch(epoch);
    revisions_.start_epoch(epoch);
    epoch_ = epoch;
  }
  std::vector<DenseCloud::Place> places;
  if (wish.wide && pose) places.push_back({pose->map_base_position[0], pose->map_base_position[1], DenseCloud::kReach});
  for (const auto& [x, y] : wish.cuts) places.push_back({x, y, DenseCloud::kCutReach});
  for (const TileKey key : cloud_.look(epoch, std::move(places))) follower().forget(key);
}

void CloudIntake::ask(std::int64_t now, const Wish& wish, Publisher& out) {
  if (!has_passed(kRequestPeriod, last_request_, now)) return;
  last_request_ = now;
  // The tiles of a cross-section may lie so far away that their owner announces them seldom.
  for (const auto& [x, y] : wish.cuts) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto key = tile_at(x + dx * kTileSize, y + dy * kTileSize);
        if (key && cloud_.is_near(*key) && !cloud_.tiles().contains(*key)) follower().lacks(*key, 1);
      }
    }
  }
  const auto& places = cloud_.places();
  if (places.empty()) return;
  const tile_request_t request = follower().make_request(now, kRequested, 300'000, places.back().x, places.back().y);
  if (request.num_tiles > 0) out.publish("TILE_REQUEST", request);
}

void CloudIntake::on(const tile_index_t& message) {
  const char* const channel = has_saliency_ ? "VOTED_POINTS" : "MAP_POINTS";
  if (!is_wanted_ || message.channel != channel) return;
  tile_index_t near = message;
  near.tile_x.clear();
  near.tile_y.clear();
  near.version.clear();
  for (std::size_t i = 0; i < message.tile_x.size(); ++i) {
    if (!cloud_.is_near({message.tile_x[i], message.tile_y[i]})) continue;
    near.tile_x.push_back(message.tile_x[i]);
    near.tile_y.push_back(message.tile_y[i]);
    near.version.push_back(message.version[i]);
  }
  near.num_tiles = static_cast<std::int32_t>(near.tile_x.size());
  follower().announced(near);
}

void CloudIntake::on(const map_points_t& message) {
  if (!is_wanted_) return;
  const DenseCloud::Put put = cloud_.put(message);
  if (put == DenseCloud::Put::kRefused) return counters_.add("refused.map_points");
  // Where both come, what is missing is asked of the voters alone: their tiles have the points.
  if (!has_saliency_) note(put, {message.tile_x, message.tile_y}, message.first + message.num_points);
}

void CloudIntake::on(const voted_points_t& message) {
  if (!is_wanted_ || !has_saliency_) return;
  const DenseCloud::Put put = cloud_.put(message);
  if (put == DenseCloud::Put::kRefused) return counters_.add("refused.voted_points");
  note(put, {message.tile_x, message.tile_y}, message.revision);
}

void CloudIntake::note(DenseCloud::Put put, TileKey key, std::int32_t announced) {
  if (put == DenseCloud::Put::kFar) follower().forget(key);
  if (put == DenseCloud::Put::kGap) follower().lacks(key, announced);
  if (put == DenseCloud::Put::kTaken || put == DenseCloud::Put::kIgnored) {
    const auto tile = cloud_.tiles().find(key);
    if (tile != cloud_.tiles().end()) follower().set_have(key, tile->second.version);
  }
}

}  // namespace curbstone::viewer
