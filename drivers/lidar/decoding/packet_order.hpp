#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "drivers/lidar/decoding/decoded_packet.hpp"
#include "drivers/lidar/decoding/refusal.hpp"

namespace curbstone::lidar::decoding {

/// A decoded packet on its way out.
struct PendingPacket {
  DecodedPacket points;
  std::int64_t received = 0;  ///< us since the Unix epoch
  std::int64_t utime = 0;     ///< of the first shot, to be published: for the user's use
  std::int64_t even = 0;      ///< the same on the host's clock without jumps
  int refused_before = 0;     ///< packets of the device that came between the one before and this, and were refused
};

/// Puts packets in the order in which they were fired, and refuses those whose stamp or azimuth cannot be. Packets have
/// no number and no checksum; what tells a damaged one is that two clocks and a heavy head go on evenly: the device's
/// stamps, the times of receipt, and the azimuth.
///
/// A packet that fits the one before goes out at once. If one or two are missing before it, it waits, for they may have
/// been overtaken: until they come, or a third has come after them. So at most two packets are held, 2.7 ms of an RS16.
/// A packet that does not fit is refused. If kAgreeing in a row fit each other, the device's clock was set, or the head
/// moved: they are the new base. The first packet is held until a second fits it, unless its stamp is the host's time.
///
/// Packets without a stamp go out as they come. Pure; one thread. Stamps in us.
class PacketOrder {
 public:
  static constexpr int kAgreeing = 10;
  static constexpr std::size_t kMostHeld = 2;

  /// What to decode the next packet into.
  [[nodiscard]] DecodedPacket& spare() { return slots_[spare_].points; }
  /// Takes the decoded packet in, or says why not.
  [[nodiscard]] Refusal take(std::int64_t received);
  /// The packet that was just taken in: valid until next().
  [[nodiscard]] PendingPacket& taken() { return slots_[taken_]; }
  /// Whether that packet came when its turn was, so that its time of receipt says something about the delay.
  [[nodiscard]] bool in_order() const { return in_order_; }
  /// Whether the last packet began a new base: nothing that was learnt of the device's clock holds any more.
  [[nodiscard]] bool began_anew() const { return began_anew_; }
  /// How many packets were taken in and then found wrong since the last call: the first one, where the second speaks
  /// against it.
  [[nodiscard]] int discarded();
  /// A packet of the device was refused elsewhere: it did come, and is not lost.
  void refused();

  /// The next packet that may go out, in order; nullptr where there is none. It stays valid until take().
  [[nodiscard]] PendingPacket* next();
  /// Nothing more is waited for: what is held may go out.
  void flush() { draining_ = held_count_ > 0; }
  [[nodiscard]] bool holds() const { return held_count_ > 0; }

  /// How often the device's clock (or head) was found elsewhere for good.
  [[nodiscard]] std::int64_t jumps() const { return jumps_; }

 private:
  struct Mark {
    std::int64_t stamp = 0;
    std::int64_t received = 0;
    int azimuth = 0;
    double rate = 0;      ///< 0.01 deg/us
    double duration = 0;  ///< us
  };
  [[nodiscard]] static Mark mark(const PendingPacket& packet);
  [[nodiscard]] static Refusal fits(const Mark& before, const Mark& packet);
  [[nodiscard]] static bool other_speed(const Mark& before, const Mark& packet);
  [[nodiscard]] static bool overlap(const Mark& before, const Mark& packet);
  [[nodiscard]] Refusal take_without_stamp();
  [[nodiscard]] Refusal doubt(const Mark& packet, Refusal why);
  [[nodiscard]] Refusal twice_or_late(const Mark& packet) const;
  [[nodiscard]] bool due(const PendingPacket& packet) const;
  [[nodiscard]] long missing(const Mark& before, const Mark& packet) const;
  void hold();
  void discard_held();

  std::array<PendingPacket, kMostHeld + 3> slots_;
  std::size_t spare_ = 0;
  std::size_t taken_ = 0;
  std::array<std::size_t, kMostHeld + 1> held_{};  ///< slots, by stamp
  std::size_t held_count_ = 0;

  std::optional<Mark> base_;  ///< the newest packet that was taken in
  bool confirmed_ = false;    ///< a second packet fitted the first
  std::optional<Mark> sent_;
  std::optional<Mark> other_;  ///< the newest packet that did not fit
  int discarded_ = 0;
  int others_ = 0;     ///< in a row, that fit each other
  int stampless_ = 0;  ///< in a row
  int refused_ = 0;    ///< packets since the last that was sent
  int sent_since_refused_ = 0;
  bool draining_ = false;
  bool began_anew_ = false;
  bool in_order_ = true;
  std::int64_t jumps_ = 0;
};

}  // namespace curbstone::lidar::decoding
