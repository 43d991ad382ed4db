#include "services/mapper/local_map.hpp"

#include <vector>

namespace curbstone::mapper {

void LocalMap::follow(const Eigen::Vector3d& position) {
  if (tracker_.forget_far()) atlas_.forget_far(position, tracker_.window());
  for (const int id : atlas_.take_returning(position, tracker_.window())) tracker_.insert_keyframe(atlas_.node(id));
}

void LocalMap::leave() {
  atlas_.leave();
}

void LocalMap::rebuild(const Pose& T_map_base, int reference) {
  const std::vector<int> ids = atlas_.surroundings(reference, T_map_base.translation(), tracker_.window());
  std::vector<const scan::Keyframe*> nodes;
  nodes.reserve(ids.size());
  for (const int id : ids) nodes.push_back(&atlas_.node(id));
  atlas_.set_present(ids, reference);
  tracker_.rebuild(nodes, T_map_base);
}

}  // namespace curbstone::mapper
