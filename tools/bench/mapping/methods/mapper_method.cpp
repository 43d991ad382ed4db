#include "tools/bench/mapping/methods/mapper_method.hpp"

#include <set>

namespace curbstone::bench::mapping::methods {
namespace {

constexpr int kEmptyListEach = 100;  // revolutions

}  // namespace

std::optional<evaluate::truth::StampedPose> MapperMethod::process(const mapper::scan::Scan& scan,
                                                                  const mapper::scan::OdometryHistory& odometry) {
  const std::optional<mapper::MapperUpdate> update = mapper_.process(scan, odometry);
  if (!update) return std::nullopt;
  covariance_ = update->registered ? std::optional(update->registration.covariance) : std::nullopt;
  rearranged_ += update->rearranged ? 1 : 0;
  // A sender of tiles empties the list of changed tiles. It is not emptied at each revolution here, because that waits
  // for the dense map, which the pose does not depend on.
  if (update->revolution % kEmptyListEach == 0) {
    mapper_.wait_inserted();
    (void)mapper_.take_changed();
  }
  return evaluate::truth::StampedPose{update->utime, update->T_map_base};
}

evaluate::truth::Trajectory MapperMethod::trajectory() const {
  evaluate::truth::Trajectory poses;
  for (const mapper::TrajectoryPoint& point : mapper_.trajectory()) poses.push_back({point.utime, point.T_map_base});
  return poses;
}

MapContent MapperMethod::content() const {
  MapContent content;
  content.points = mapper_.dense().size();
  content.bytes_per_point = 7;  // int16 x y z and intensity, as in map_points_t
  std::int64_t cells = 0;
  for (const TileKey& key : mapper_.dense().keys()) {
    std::set<std::pair<int, int>> seen;
    for (const TilePoint& p : mapper_.dense().tile(key)->read()->points()) {
      seen.emplace(p.x * kCellsPerTile / kStepsPerTile, p.y * kCellsPerTile / kStepsPerTile);
    }
    cells += static_cast<std::int64_t>(seen.size());
  }
  content.square_metres = static_cast<double>(cells) * kCellSize * kCellSize;
  content.local_elements = static_cast<std::int64_t>(mapper_.registration_size());
  return content;
}

}  // namespace curbstone::bench::mapping::methods
