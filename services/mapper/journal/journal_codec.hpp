#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "services/mapper/journal/recorded_drive.hpp"

namespace curbstone::mapper::journal {

/// Serialises the items of a journal, appended to `out`. In the byte order of this machine: no other reads them.

void append_head(std::string& out, const std::string& config_hash, std::int32_t epoch, std::int32_t num_known);
/// Another mapper continues the drive in this epoch: of the earlier poses those up to `until`, us, count.
void append_epoch(std::string& out, std::int32_t epoch, std::int64_t until);
void append_node(std::string& out, const scan::Keyframe& node, double driven);
void append_edge(std::string& out, const pose_graph::PoseEdge& edge);
void append_pose(std::string& out, const RecordedPose& pose);
/// The part of a tile that follows its first `records` records in `runs` runs.
void append_tile(std::string& out, TileKey key, std::int32_t z_origin, const dense_map::TileRecords& tile,
                 std::size_t records, std::size_t runs);
void append_eviction(std::string& out, TileKey key);
void append_rings(std::string& out, const intensity::RingHistograms& rings);

/// Applies a batch of items to the drive; tiles that grow are marked with batch number `batch`. Throws
/// std::runtime_error if an item is impossible: the drive must then be discarded.
void apply_items(std::string_view items, RecordedDrive& drive, std::size_t batch);

/// Throws std::runtime_error if tiles, edges or poses refer to something that does not exist.
void check_drive(const RecordedDrive& drive);

}  // namespace curbstone::mapper::journal
