#include "services/mapper/dense_map/tile_records.hpp"

#include <type_traits>
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

/// Packs one field of all values: as the steps from each to the next, which are small. Unsigned, as some may be large.
template <class Value, class Field>
void pack_field(const std::vector<Value>& values, Field Value::*field, ValuePacker& packer) {
  using Step = std::make_unsigned_t<Field>;
  std::vector<Step> steps;
  steps.reserve(values.size());
  Step last = 0;
  for (const Value& value : values) {
    const auto now = static_cast<Step>(value.*field);
    steps.push_back(static_cast<Step>(now - last));
    last = now;
  }
  packer.put(steps);
}

template <class Value, class Field>
void unpack_field(ValueUnpacker& unpacker, Field Value::*field, std::vector<Value>& values) {
  using Step = std::make_unsigned_t<Field>;
  std::vector<Step> steps;
  unpacker.take(steps);
  values.resize(steps.size());
  Step now = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    now = static_cast<Step>(now + steps[i]);
    values[i].*field = static_cast<Field>(now);
  }
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
  pack_field(records.records, &TilePoint::x, packer);
  pack_field(records.records, &TilePoint::y, packer);
  pack_field(records.records, &TilePoint::z, packer);
  pack_field(records.records, &TilePoint::intensity, packer);
  pack_field(records.runs, &Run::anchor, packer);
  pack_field(records.runs, &Run::first, packer);
  pack_field(records.runs, &Run::utime, packer);
  values_ = file.put(packer.pack());
}

TileRecords PackedRecords::read() const {
  TileRecords records;
  if (empty()) return records;
  ValueUnpacker unpacker(values_.read());
  unpack_field(unpacker, &TilePoint::x, records.records);
  unpack_field(unpacker, &TilePoint::y, records.records);
  unpack_field(unpacker, &TilePoint::z, records.records);
  unpack_field(unpacker, &TilePoint::intensity, records.records);
  unpack_field(unpacker, &Run::anchor, records.runs);
  unpack_field(unpacker, &Run::first, records.runs);
  unpack_field(unpacker, &Run::utime, records.runs);
  return records;
}

}  // namespace curbstone::mapper::dense_map
