#pragma once

#include <cstdint>
#include <optional>

namespace curbstone::lidar::decoding {

/// An interval of the head's rotation, between two blocks of a packet, in which nothing was fired. 0.01 deg, clockwise.
struct Gap {
  int from = 0;   ///< azimuth of the last block before it
  int width = 0;  ///< up to the next block's azimuth
};

/// The sector in which the device does not fire, if it is configured so. A jump of the azimuth counts as the blind zone
/// only if the device itself reports it (its field of view), or if it was seen at the same place in two revolutions and
/// each time took as long as the head needs for it. A single damaged azimuth satisfies neither. Pure; one thread.
class BlindZone {
 public:
  /// The device's own report: it fires from `start` clockwise to `end`, 0.01 deg; equal, or 0 and 36000: everywhere.
  void set_field_of_view(int start, int end);

  /// deg in which the device fires.
  [[nodiscard]] double field_of_view() const { return reported_ ? 360.0 - reported_->width * 0.01 : 360.0; }

  [[nodiscard]] bool is(const Gap& gap) const;

  /// Takes a packet with this gap, which is not the known blind zone, and its stamp (us). The packet lasts `without` us
  /// if its azimuth is damaged, and `with` us if the gap is a blind zone: the stamp of the next packet decides.
  void suspect(const Gap& gap, std::int64_t stamp, double without, double with);
  /// Takes the next packet's stamp, us.
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
