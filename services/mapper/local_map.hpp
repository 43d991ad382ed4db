#pragma once

#include "common/geometry/geometry.hpp"
#include "services/mapper/pose_graph/atlas.hpp"
#include "services/mapper/tracking/tracker.hpp"

namespace curbstone::mapper {

/// The surroundings that scans are registered to. The atlas says which keyframes belong to them (those that are
/// present), the tracker's registration map holds their points. Only this object changes either, so the two agree.
/// Pure; one thread.
class LocalMap {
 public:
  /// Both must outlive it.
  LocalMap(pose_graph::Atlas& atlas, tracking::Tracker& tracker) : atlas_(atlas), tracker_(tracker) {}

  /// The vehicle is at `position` (map, m): keyframes out of the window leave, those that come into it enter.
  void follow(const Eigen::Vector3d& position);
  /// The tracker began with an empty registration map: all keyframes leave.
  void leave();
  /// Made anew from the keyframes about the vehicle, so far as drift has not displaced them from `reference`, the one
  /// that it is at.
  void rebuild(const Pose& T_map_base, int reference);

 private:
  pose_graph::Atlas& atlas_;
  tracking::Tracker& tracker_;
};

}  // namespace curbstone::mapper
