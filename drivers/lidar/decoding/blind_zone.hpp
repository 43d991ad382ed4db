#pragma once

#include <cstdint>
#include <optional>

namespace curbstone::lidar::decoding {

/// A turn of the head in which nothing was fired, between two blocks of a packet. 0.01 deg, clockwise.
struct Gap {
  int from = 0;   ///< azimuth of the last block before it
  int width = 0;  ///< to the next block's azimuth
};

/// The part of the turn in which the device does not fire, where it is set so. A jump of the azimuth is taken for it
/// only where the device itself says so (its field of view), or where it was seen at the same place in two turns and
/// each time the time had passed that the head needs for it. One damaged azimuth is neither. Pure; one thread.
class BlindZone {
 public:
  /// As the device says: it fires from `start` clockwise to `end`, 0.01 deg; equal, or 0 and 36000: everywhere.
  void set_field_of_view(int start, int end);

  /// deg that the device fires in.
  [[nodiscard]] double field_of_view() const { return reported_ ? 360.0 - reported_->width * 0.01 : 360.0; }

  [[nodiscard]] bool is(const Gap& gap) const;

  /// A packet with this gap, which was not the blind zone, came with this stamp (us). It lasts `without` us if its
  /// azimuth is damaged, and `with` if it is a blind zone: the stamp of the packet after it tells.
  void suspect(const Gap& gap, std::int64_t stamp, double without, double with);
  /// The next packet's stamp, us.
  void next_stamp(std::int64_t stamp);

 private:
  struct Suspect {
    Gap gap;
    std::int64_t stamp = 0;
    double without = 0;
    double with = 0;
  };
  std::optional<Gap> reported_;
  std::optional<Gap> learnt_;
  std::optional<Gap> seen_once_;
  std::optional<Suspect> suspect_;
};

}  // namespace curbstone::lidar::decoding
