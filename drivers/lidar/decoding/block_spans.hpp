#pragma once

#include <cstdint>
#include <span>

namespace curbstone::lidar::decoding {

/// How far the head turns within one data block, and when the block begins.
struct BlockSpan {
  double angle = 0;  ///< in the unit of the azimuths
  double start = 0;  ///< in the unit of the block period, after the packet's first shot
};

/// A packet gives only the azimuth of each block's first shot (0.01 deg, 0..35999). The head turns within a block by
/// the step to the next block's azimuth; within the last block, by `nominal`. A step of more than 1 deg is a blind
/// zone, in which the device does not fire. The block before it turns by `nominal`, and the gap gives the time to pass
/// the zone. Source: rs_driver 4eeadace, Rs16SingleReturnBlockIterator (which takes the blind zone's width from DIFOP).
///
/// `spans` has as many elements as `azimuths`. A small step back (jitter of a standing head) stays one.
void block_spans(std::span<const std::uint16_t> azimuths, double nominal, double block_period,
                 std::span<BlockSpan> spans);

/// The mean step of a packet without its blind zones, 0.01 deg: the best `nominal`. Negative or 0 when the head stands.
/// `otherwise` when there is no step to take a mean of.
[[nodiscard]] double mean_block_step(std::span<const std::uint16_t> azimuths, double otherwise);

}  // namespace curbstone::lidar::decoding
