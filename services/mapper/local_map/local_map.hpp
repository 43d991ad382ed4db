#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/pose_graph/atlas.hpp"
#include "services/mapper/registration/registration.hpp"
#include "services/mapper/registration/shape_map.hpp"
#include "services/mapper/tracking/tracker.hpp"

namespace curbstone::mapper::local_map {

/// A local map that is not in use yet.
struct NewLocalMap {
  std::vector<int> present;  ///< its keyframes
  int num_known = 0;         ///< keyframes of the atlas that it was built from
  std::unique_ptr<registration::Registration> registration;
};

/// Builds the local map around the vehicle. Keyframes that drift may have displaced from `reference`, the keyframe that
/// the vehicle is at, are left out. `empty`: the registration map to fill. Pure.
[[nodiscard]] NewLocalMap build_local_map(const pose_graph::Atlas& atlas, const Pose& T_map_base, int reference,
                                          std::unique_ptr<registration::Registration> empty);

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
  /// Replaces the local map by `map`, to which it adds the keyframes made since that was begun. The vehicle is at
  /// T_map_base and at the keyframe `reference`.
  void replace(NewLocalMap map, const Pose& T_map_base, int reference);
  /// Rebuilds the local map from the keyframes around the vehicle.
  void rebuild(const Pose& T_map_base, int reference) {
    replace(build_local_map(atlas_, T_map_base, reference, tracker_.empty_map()), T_map_base, reference);
  }
  /// Takes over the local map of another mapper, voxel by voxel: `levels` are those of its registration map. The
  /// vehicle is at T_map_base and at the keyframe `reference`.
  void restore(std::span<const std::vector<registration::VoxelSums>> levels, const Pose& T_map_base, int reference);

 private:
  pose_graph::Atlas& atlas_;
  tracking::Tracker& tracker_;
};

}  // namespace curbstone::mapper::local_map
