#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "drivers/lidar/decoding/compaction.hpp"
#include "drivers/lidar/decoding/decoded_packet.hpp"
#include "drivers/lidar/decoding/fired_packet.hpp"

namespace curbstone::lidar::decoding {

/// Converts the returns of a packet to points, in firing order. A sine and a cosine are looked up once per block;
/// within it the head turns by at most 1 deg, for which a few terms of the series are exact to 1e-15. Use: construct
/// it, add() each block, then finish().
class PointWriter {
 public:
  static constexpr std::size_t kMaxPoints = 12 * kRecordsPerBlock;  ///< points of a packet: one per record

  PointWriter(std::shared_ptr<const PointRules> rules, DecodedPacket& packet);

  /// Adds a block, or two blocks of the same shots: first one return of each, then the other.
  void add(const BlockPlace& place, std::span<const BlockRecords> returns);
  void add(const BlockPlace& place, const BlockRecords& records) { add(place, std::span(&records, 1)); }
  void finish();

 private:
  /// A value per record of a block; after them, or interleaved, those of the block with the shots' other returns.
  template <class Value>
  using Figures = std::array<Value, 2 * kRecordsPerBlock>;

  void place_all(const BlockPlace& place, std::span<const BlockRecords> returns);
  void choose(std::span<const BlockRecords> returns);
  void leave_out_sector(const BlockPlace& place, std::size_t records);
  void put_returns_side_by_side();
  [[nodiscard]] bool in_sector(double azimuth_deg) const;

  const PointRules& rules_;  ///< the packet's
  bool whole_turn_;
  unsigned least_;  ///< minimum published distance, in steps
  unsigned most_;
  DecodedPacket& packet_;
  std::size_t count_ = 0;
  std::array<std::uint32_t, kMaxPoints + kCompactionSlack> marks_;  ///< of all points: ring and intensity

  // Of the current block. Values of records without a return are undefined.
  alignas(64) Figures<float> x_;
  alignas(64) Figures<float> y_;
  alignas(64) Figures<float> z_;
  alignas(64) Figures<float> time_;
  Figures<std::uint32_t> mark_;
  Figures<std::uint8_t> goes_out_;  ///< 1 or 0
};

/// Computes the points of a packet again, bit for bit. Of the packet's other members only the counts of returns are
/// set.
void make_points(const FiredPacket& fired, DecodedPacket& packet);

}  // namespace curbstone::lidar::decoding
