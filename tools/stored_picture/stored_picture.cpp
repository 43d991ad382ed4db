#include "tools/stored_picture/stored_picture.hpp"

namespace curbstone::output {

semantic_map::picture::MapPicture stored_picture(const semantic_map::store::MapReader& map) {
  semantic_map::picture::MapPicture picture;
  picture.tiles = map.tiles();
  picture.curbs = map.curbs();
  picture.markings = map.markings();
  for (const auto& pose : map.trajectory()) picture.path.emplace_back(pose.T_map_base.translation().head<2>());
  return picture;
}

}  // namespace curbstone::output
