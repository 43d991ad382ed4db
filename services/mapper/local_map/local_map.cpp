#include "services/mapper/local_map/local_map.hpp"

#include <algorithm>
#include <utility>

namespace curbstone::mapper::local_map {

NewLocalMap build_local_map(const pose_graph::Atlas& atlas, const Pose& T_map_base, int reference,
                            std::unique_ptr<registration::Registration> empty) {
  NewLocalMap map{atlas.surroundings(reference, T_map_base.translation(), empty->window()), atlas.size(),
                  std::move(empty)};
  for (const int id : map.present) map.registration->insert_keyframe(atlas.node(id));
  (void)map.registration->keep_around(T_map_base.translation());
  return map;
}

void LocalMap::follow(const Eigen::Vector3d& position) {
  if (tracker_.forget_far()) atlas_.forget_far(position, tracker_.window());
  for (const int id : atlas_.take_returning(position, tracker_.window())) tracker_.insert_keyframe(atlas_.node(id));
}

void LocalMap::leave() {
  atlas_.leave();
}

void LocalMap::restore(std::span<const std::vector<registration::VoxelSums>> levels, const Pose& T_map_base,
                       int reference) {
  NewLocalMap map{{}, atlas_.size(), tracker_.empty_map()};
  map.present = atlas_.surroundings(reference, T_map_base.translation(), map.registration->window());
  const std::vector<registration::ShapeLevel*> to = map.registration->levels();
  for (std::size_t i = 0; i < std::min(to.size(), levels.size()); ++i) to[i]->restore(levels[i]);
  replace(std::move(map), T_map_base, reference);
}

void LocalMap::replace(NewLocalMap map, const Pose& T_map_base, int reference) {
  const auto add = [&](int id) {
    map.registration->insert_keyframe(atlas_.node(id));
    map.present.push_back(id);
  };
  if (std::find(map.present.begin(), map.present.end(), reference) == map.present.end() && reference < map.num_known)
    add(reference);
  for (int id = map.num_known; id < atlas_.size(); ++id) add(id);
  atlas_.set_present(map.present, reference);
  tracker_.replace_map(std::move(map.registration), T_map_base);
}

}  // namespace curbstone::mapper::local_map
