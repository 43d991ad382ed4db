#pragma once

#include "common/geometry/geometry.hpp"
#include "services/mapper/pose_graph/atlas.hpp"
#include "services/mapper/tracking/tracker.hpp"

namespace curbstone::mapper {

/// The local map that scans are registered to. The atlas marks the keyframes that belong to it as present; the
/// tracker's registration map holds their points. Only this object changes either of them, so they stay consistent.
/// Pure; one thread.
class LocalMap {
 public:
  /// `atlas` and `tracker` must outlive this object.
  LocalMap(pose_graph::Atlas& atlas, tracking::Tracker& tracker) : atlas_(atlas), tracker_(tracker) {}

  /// Moves the window to the vehicle's `position` (map, m): keyframes outside it leave, keyframes inside it enter.
  void follow(const Eigen::Vector3d& position);
  /// Removes all keyframes: the tracker has begun an empty registration map.
  void leave();
  /// Rebuilds the local map from the keyframes around the vehicle. Keyframes that drift may have displaced from
  /// `reference`, the keyframe that the vehicle is at, are left out.
  void rebuild(const Pose& T_map_base, int reference);

 private:
  pose_graph::Atlas& atlas_;
  tracking::Tracker& tracker_;
};

}  // namespace curbstone::mapper
