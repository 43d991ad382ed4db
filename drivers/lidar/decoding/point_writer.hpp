#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/lidar/decoding/compaction.hpp"
#include "drivers/lidar/decoding/decoded_packet.hpp"
#include "drivers/lidar/decoding/shot_table.hpp"

namespace curbstone::lidar::decoding {

/// Which returns go out.
struct ReturnLimits {
  double min_range = 0.4;  ///< m; nearer returns are left out
  double max_range = 150.0;
  double start_angle = 0.0;  ///< deg, clockwise: returns from here ...
  double end_angle = 360.0;  ///< ... to before here; equal, or 0 and 360: all
};

/// How a device writes distances. 0 is no return.
struct DistanceUnit {
  double step = 0;              ///< m
  std::uint16_t no_return = 0;  ///< another word for none
};

/// The records of a data block as they are in the packet.
struct BlockRecords {
  std::array<std::uint16_t, kRecordsPerBlock> distance{};
  std::array<std::uint8_t, kRecordsPerBlock> intensity{};
  int repeats = 0;  ///< set to distance 0 because they repeat the shot's other return: no shots without a return

  void leave_out(std::size_t record) {
    distance[record] = 0;
    ++repeats;
  }
};

/// Where the head was when a block's shots were fired.
struct BlockPlace {
  int azimuth = 0;             ///< 0.01 deg, 0..35999, clockwise, at the first shot
  double turned_a_second = 0;  ///< deg/s, within the block
  double start = 0;            ///< s from the packet's first shot to the block's
};

/// Turns the returns of a packet into points, in the order in which they were fired. A sine and a cosine are looked
/// up once a block; within it the head turns by at most 1 deg, for which few terms of the series are exact to 1e-15.
/// Use: construct it, add() each block, then finish().
class PointWriter {
 public:
  static constexpr std::size_t kMost = 12 * kRecordsPerBlock;  ///< points of a packet: a record each

  /// `lens_offset`: m from the axis to the lenses, in the direction of the head's azimuth. `shots` must outlive it.
  PointWriter(const ReturnLimits& limits, const DistanceUnit& unit, const ShotTable& shots, double lens_offset,
              DecodedPacket& packet);

  /// A block, or two of the same shots: first one return of each, then the other.
  void add(const BlockPlace& place, std::span<const BlockRecords> returns);
  void add(const BlockPlace& place, const BlockRecords& records) { add(place, std::span(&records, 1)); }
  void finish();

 private:
  /// A figure of each record of a block; after them, or in between, those of the block with the shots' other returns.
  template <class Value>
  using Figures = std::array<Value, 2 * kRecordsPerBlock>;

  void place_all(const BlockPlace& place, std::span<const BlockRecords> returns);
  void choose(std::span<const BlockRecords> returns);
  void leave_out_sector(const BlockPlace& place, std::size_t records);
  void put_returns_side_by_side();
  [[nodiscard]] bool in_sector(double azimuth_deg) const;

  ReturnLimits limits_;
  bool whole_turn_;
  DistanceUnit unit_;
  unsigned least_;  ///< distance that goes out, in steps
  unsigned most_;
  const ShotTable& shots_;
  double lens_offset_;
  DecodedPacket& packet_;
  std::size_t count_ = 0;
  std::array<std::uint32_t, kMost + kCompactionSlack> marks_;  ///< of all points: ring and intensity

  // Of the block in hand. What has no return means nothing.
  alignas(64) Figures<float> x_;
  alignas(64) Figures<float> y_;
  alignas(64) Figures<float> z_;
  alignas(64) Figures<float> time_;
  Figures<std::uint32_t> mark_;
  Figures<std::uint8_t> goes_out_;  ///< 1 or 0
};

}  // namespace curbstone::lidar::decoding
