#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "services/mapper/journal/recorded_drive.hpp"

namespace curbstone::mapper::journal {

/// The items of a journal as bytes, appended to `out`. In the byte order of this machine: no other reads them.

void append_head(std::string& out, const std::string& config_hash, std::int32_t epoch, std::int32_t num_known);
void append_node(std::string& out, const scan::Keyframe& node, double driven);
void append_edge(std::string& out, const pose_graph::PoseEdge& edge);
void append_pose(std::string& out, const RecordedPose& pose);
/// What a tile has more than `records` records in `runs` runs.
void append_tile(std::string& out, TileKey key, std::int32_t z_origin, const dense_map::TileRecords& tile,
                 std::size_t records, std::size_t runs);
void append_eviction(std::string& out, TileKey key);
void append_rings(std::string& out, const intensity::RingHistograms& rings);

/// Adds what a batch of items says to the drive, whose tiles grow in batch number `batch` then. Throws
/// std::runtime_error where it says what cannot be: the drive is then of no use.
void apply_items(std::string_view items, RecordedDrive& drive, std::size_t batch);

/// Throws std::runtime_error where tiles, edges or poses speak of what is not there.
void check_drive(const RecordedDrive& drive);

}  // namespace curbstone::mapper::journal
