#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

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

/// How the returns of a device become points. It stays as it is: when the device becomes another, there is another one.
struct PointRules {
  ReturnLimits limits;
  DistanceUnit unit;
  double lens_offset = 0;  ///< m from the axis to the lenses, in the direction of the head's azimuth
  ShotTable shots;
};

/// The records of a data block as they are in the packet.
struct BlockRecords {
  std::array<std::uint16_t, kRecordsPerBlock> distance{};
  std::array<std::uint8_t, kRecordsPerBlock> intensity{};
  std::int32_t repeats = 0;  ///< set to distance 0 because they repeat the shot's other return: no shots without one

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

/// What the points of a packet are made of: make_points() makes the same ones again. It takes a quarter of their
/// memory.
struct FiredPacket {
  std::shared_ptr<const PointRules> rules;
  std::vector<BlockPlace> places;
  std::vector<BlockRecords> records;  ///< one or two of each place: first one return of each shot, then the other

  [[nodiscard]] std::size_t bytes() const {
    return places.size() * sizeof(BlockPlace) + records.size() * sizeof(BlockRecords);
  }
};

}  // namespace curbstone::lidar::decoding
