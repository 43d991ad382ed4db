#include "services/mapper/dense_map/tile_records.hpp"

#include <unordered_map>

#include "common/packing/value_packer.hpp"

namespace curbstone::mapper::dense_map {
namespace {

using Run = TileRecords::Run;

/// Names a place in a tile.
std::uint64_t place_key_of(const TilePoint& point) {
  return (static_cast<std::uint64_t>(static_cast<std::uint16_t>(point.x)) << 32) |
         (static_cast<std::uint64_t>(static_cast<std::uint16_t>(point.y)) << 16) | static_cast<std::uint16_t>(point.z);
}

}  // namespace

std::vector<bool> TileRecords::standing() const {
  std::vector<bool> there(records.size(), true);
  std::unordered_map<std::uint64_t, std::size_t> at;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (!is_removal(records[i])) {
      at[place_key_of(records[i])] = i;
      continue;
    }
    there[i] = false;
    there[at.at(place_key_of(removal_of(records[i])))] = false;
  }
  return there;
}

std::vector<TilePoint> TileRecords::points() const {
  const std::vector<bool> there = standing();
  std::vector<TilePoint> points;
  points.reserve(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (there[i]) points.push_back(records[i]);
  }
  return points;
}

PackedRecords::PackedRecords(const TileRecords& records, SpillFile& file) {
  ValuePacker packer;
  packer.put_steps(records.records, &TilePoint::x);
  packer.put_steps(records.records, &TilePoint::y);
  packer.put_steps(records.records, &TilePoint::z);
  packer.put_steps(records.records, &TilePoint::intensity);
  packer.put_steps(records.runs, &Run::anchor);
  packer.put_steps(records.runs, &Run::first);
  packer.put_steps(records.runs, &Run::utime);
  values_ = file.put(packer.pack());
}

TileRecords PackedRecords::read() const {
  TileRecords records;
  if (empty()) return records;
  ValueUnpacker unpacker(values_.read());
  unpacker.take_steps(records.records, &TilePoint::x);
  unpacker.take_steps(records.records, &TilePoint::y);
  unpacker.take_steps(records.records, &TilePoint::z);
  unpacker.take_steps(records.records, &TilePoint::intensity);
  unpacker.take_steps(records.runs, &Run::anchor);
  unpacker.take_steps(records.runs, &Run::first);
  unpacker.take_steps(records.runs, &Run::utime);
  return records;
}

}  // namespace curbstone::mapper::dense_map
