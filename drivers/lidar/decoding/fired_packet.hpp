#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "drivers/lidar/decoding/shot_table.hpp"

namespace curbstone::lidar::decoding {

/// Which returns are published.
struct ReturnLimits {
  double min_range = 0.4;  ///< m; nearer returns are left out
  double max_range = 150.0;
  double start_angle = 0.0;  ///< deg, clockwise: returns from here ...
  double end_angle = 360.0;  ///< ... to before here; equal, or 0 and 360: all
};

/// Encoding of distances. 0 means no return.
struct DistanceUnit {
  double step = 0;              ///< m
  std::uint16_t no_return = 0;  ///< another value that means no return
};

/// How a device's returns become points. Immutable: when the device changes, a new object is made.
struct PointRules {
  ReturnLimits limits;
  DistanceUnit unit;
  double lens_offset = 0;  ///< m from the axis to the lenses, in the direction of the head's azimuth
  ShotTable shots;
};

/// The records of a data block as in the packet.
struct BlockRecords {
  std::array<std::uint16_t, kRecordsPerBlock> distance{};
  std::array<std::uint8_t, kRecordsPerBlock> intensity{};
  std::int32_t repeats = 0;  ///< set to distance 0: they repeat the shot's other return, and do not count as no return

  void leave_out(std::size_t record) {
    distance[record] = 0;
    ++repeats;
  }
};

/// Azimuth and time of a block's shots.
struct BlockPlace {
  int azimuth = 0;             ///< 0.01 deg, 0..35999, clockwise, at the first shot
  double turned_a_second = 0;  ///< deg/s, within the block
  double start = 0;            ///< s from the packet's first shot to the block's
};

/// The data from which a packet's points are made: make_points() reproduces them. It takes a quarter of their memory.
struct FiredPacket {
  std::shared_ptr<const PointRules> rules;
  std::vector<BlockPlace> places;
  std::vector<BlockRecords> records;  ///< one or two per place: first one return of each shot, then the other

  [[nodiscard]] std::size_t bytes() const {
    return places.size() * sizeof(BlockPlace) + records.size() * sizeof(BlockRecords);
  }
};

}  // namespace curbstone::lidar::decoding
