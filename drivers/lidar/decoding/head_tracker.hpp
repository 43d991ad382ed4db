#pragma once

#include <cstdint>
#include <optional>

namespace curbstone::lidar::decoding {

/// Follows the rotating head from packet to packet. RS16 packets have no sequence number: losses are estimated from the
/// angle that the head turned in between. Pure; one thread. Angles are integers in 0.01 deg, clockwise seen from above,
/// as in the packets, so sums are exact.
class HeadTracker {
 public:
  struct Step {
    std::int32_t revolution = 0;  ///< of this packet; increments when the azimuth passes the cut angle, never decreases
    std::int64_t lost = 0;        ///< packets, estimated, between the previous one and this one
    bool duplicate = false;       ///< the same packet again: to be ignored
    bool late = false;            ///< fired shortly before the latest packet: to be ignored
  };

  struct Packet {
    std::int64_t utime = 0;  ///< of the first shot, on any clock that is accurate to a quarter turn
    int azimuth = 0;         ///< of the first shot
    double rate = 0;         ///< 0.01 deg/s, rotation of the head
    double duration = 0;     ///< s
  };

  explicit HeadTracker(int cut_angle) : cut_angle_(cut_angle) {}

  /// `blind`: how far the head may turn without firing.
  Step follow(const Packet& packet, double blind = 0);
  /// The clock of the packets was set by that many us: the step between two packets is no time in which the head
  /// turned.
  void clock_was_set(std::int64_t by) {
    if (last_) last_->utime += by;
  }

 private:
  int cut_angle_;
  std::optional<Packet> last_;
  std::int64_t turned_ = 0;  ///< since the cut angle at the start of revolution 0
  std::int32_t scan_ = 0;
};

}  // namespace curbstone::lidar::decoding
