#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "services/mapper/storage/saved_map.hpp"

namespace curbstone::mapper::storage {

/// A map on disk is a folder:
///
///     map.yaml           format, voxel, epoch, counts; written last
///     tiles.csv          x, y, z_origin, utime of each tile
///     tiles/X_Y.pcd      its points: x y z intensity, float32, in map
///     nodes.csv          utime and T_map_base (3x4, row by row) of each node
///     nodes/000000.pcd   its points: x y z, float32, in base_link; the pose as VIEWPOINT
///     graph.csv          from, to, loop, T_from_to (3x4), information (6x6)
///     rings.csv          of each ring of the LiDAR, how often it gave the road each intensity from 0 to 255; maps of
///                        earlier versions have none, and intensities as they came
///
/// What load_map() returns equals what save_map() got, bit for bit: points are whole 2 mm steps, which float32 tells
/// apart up to 32 km from the map's origin; other numbers are written with all their digits.
inline constexpr int kMapFormat = 1;

/// What a saved map lacks.
struct LeftOut {
  std::vector<TileKey> gone;           ///< tiles
  std::vector<TileKey> earlier;        ///< tiles of which it has SavedTile::earlier
  std::vector<std::size_t> keyframes;  ///< that have lost their scan
  [[nodiscard]] std::size_t size() const { return gone.size() + earlier.size() + keyframes.size(); }
};

/// Takes parts of a map as they are read, so that the whole of it is never in memory.
struct MapTaker {
  std::function<void(SavedTile)> tile;
  std::function<void(scan::Keyframe)> node;
};

/// Replaces the map in `folder`, if there is one, in one step once the new one is complete and on the disk: a crash at
/// any time leaves the old or the new. Until then the new one grows in `folder`.partial; one process at a time.
/// What is on_disk stays the file that it is (a hard link): only what is new is written.
/// What the file of far tiles does not give back is left out, and all else is saved.
/// Throws MapFolderError: what cannot be written, or is not on the disk, a map that load_map() would refuse, or a
/// folder that holds anything but a map (which is left alone).
LeftOut save_map(const SavedMap& map, const std::filesystem::path& folder);

/// Throws MapFolderError: a file that is missing, truncated, too large, or of a newer format; a point that is not
/// finite, outside its tile, off the 2 mm steps or in another's voxel; a pose that is none; an edge to nowhere.
/// Memory stays within a small multiple of what lies on the disk.
[[nodiscard]] SavedMap load_map(const std::filesystem::path& folder);
/// Likewise, but tiles and nodes go to the taker, one after the other, and are not in what it returns. When it throws,
/// some have gone there.
[[nodiscard]] SavedMap load_map(const std::filesystem::path& folder, const MapTaker& taker);

}  // namespace curbstone::mapper::storage
