#include "services/mapper/local_map/solved_loop.hpp"

#include <utility>

namespace curbstone::mapper::local_map {

SolvedLoop solve_loop(pose_graph::Atlas atlas, const pose_graph::LoopCloser& closer,
                      const pose_graph::LoopClosure& closure, const Pose& T_map_base,
                      std::unique_ptr<registration::Registration> empty) {
  SolvedLoop solved;
  solved.correction = closer.solve(atlas, closure, T_map_base);
  if (!solved.correction || !closer.is_significant(*solved.correction, atlas)) return solved;
  const Pose& here = solved.correction->T_new_old[static_cast<std::size_t>(atlas.reference())];
  atlas.add_loop(solved.correction->loop);
  atlas.move(solved.correction->T_new_old);
  solved.local_map = build_local_map(atlas, normalised(here * T_map_base), atlas.reference(), std::move(empty));
  return solved;
}

}  // namespace curbstone::mapper::local_map
