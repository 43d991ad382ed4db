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
/// load_map() returns exactly what save_map() got, bit for bit: points are whole 2 mm steps, which float32 resolves up
/// to 32 km from the map's origin; other numbers are written with all their digits.
inline constexpr int kMapFormat = 1;

/// What a saved map lacks.
struct MissingParts {
  std::vector<TileKey> gone;           ///< tiles that are missing
  std::vector<TileKey> earlier;        ///< tiles of which the map has an earlier version, SavedTile::earlier
  std::vector<std::size_t> keyframes;  ///< keyframes without their scan
  [[nodiscard]] std::size_t size() const { return gone.size() + earlier.size() + keyframes.size(); }
};

/// Receives parts of a map as they are read, so that the map is never in memory as a whole.
struct MapVisitor {
  std::function<void(SavedTile)> tile;
  std::function<void(scan::Keyframe)> node;
};

/// Replaces the map in `folder`, if there is one, in one step, once the new one is complete and on the disk: a crash at
/// any time leaves the old or the new one. Until then the new one is in `folder`.partial; one process at a time. Files
/// of what is on_disk are reused (as hard links): only what is new is written. What cannot be read back from the file
/// of far tiles is left out; all else is saved. Throws MapFolderError if something cannot be written or synced, for a
/// map that load_map() would refuse, or for a folder that contains anything but a map (it is left alone).
MissingParts save_map(const SavedMap& map, const std::filesystem::path& folder);

/// Loads a map. Throws MapFolderError for a file that is missing, truncated, too large, or of a newer format; a point
/// that is not finite, outside its tile, off the 2 mm steps or in another point's voxel; an invalid pose; an edge to a
/// node that does not exist. Memory stays within a small multiple of the size on disk.
[[nodiscard]] SavedMap load_map(const std::filesystem::path& folder);
/// The same, but tiles and nodes are passed to the taker one by one, and are not in the result. If it throws, the taker
/// may have received some.
[[nodiscard]] SavedMap load_map(const std::filesystem::path& folder, const MapVisitor& visitor);

}  // namespace curbstone::mapper::storage
