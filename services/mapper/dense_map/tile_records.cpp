#include "services/mapper/dense_map/tile_records.hpp"

#include <unordered_map>

#include "common/packing/value_packer.hpp"

namespace curbstone::mapper::dense_map {
namespace {

using Run = TileRecords::Run;

/// Visits every field of points and runs, in the order in which they are packed.
template <class Records, class Visit>
void visit_fields(Records& records, const Visit& visit) {
  visit(records.records, &TilePoint::x);
  visit(records.records, &TilePoint::y);
  visit(records.records, &TilePoint::z);
  visit(records.records, &TilePoint::intensity);
  visit(records.runs, &Run::anchor);
  visit(records.runs, &Run::first);
  visit(records.runs, &Run::utime);
}

}  // namespace

std::vector<bool> TileRecords::standing() const {
  std::vector<bool> there(records.size(), true);
  std::unordered_map<std::uint64_t, std::size_t> at;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (!is_removal(records[i])) {
      at[place_key(records[i])] = i;
      continue;
    }
    there[i] = false;
    there[at.at(place_key(removal_of(records[i])))] = false;
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
  visit_fields(records, [&](const auto& values, auto field) { packer.put_steps(values, field); });
  values_ = file.put(packer.pack());
}

TileRecords PackedRecords::read() const {
  TileRecords records;
  if (empty()) return records;
  ValueUnpacker unpacker(values_.read());
  visit_fields(records, [&](auto& values, auto field) { unpacker.take_steps(values, field); });
  return records;
}

}  // namespace curbstone::mapper::dense_map
