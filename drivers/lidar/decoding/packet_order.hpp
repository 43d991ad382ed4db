#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "drivers/lidar/decoding/decoded_packet.hpp"
#include "drivers/lidar/decoding/refusal.hpp"

namespace curbstone::lidar::decoding {

/// A decoded packet that waits to be published.
struct PendingPacket {
  DecodedPacket points;
  std::int64_t received = 0;    ///< us since the Unix epoch
  std::int64_t utime = 0;       ///< of the first shot, to be published; set by the user of PacketOrder
  std::int64_t host_utime = 0;  ///< the same on the host's clock without jumps
  int refused_before = 0;       ///< refused packets of the device between the previous one and this one
};

/// Puts packets in firing order, and refuses those with an implausible stamp or azimuth. Packets have no number and no
/// checksum. A damaged one is recognised because two clocks and a heavy head run evenly: the device's stamps, the times
/// of receipt, and the azimuth.
///
/// A packet that fits the previous one is released at once. If one or two are missing before it, it waits, because they
/// may have been overtaken: until they arrive, or a third one has arrived after them. So at most two packets are held,
/// 2.7 ms of an RS16. A packet that does not fit is refused. If kAgreeing in a row fit each other, the device's clock
/// was set, or the head moved: they are the new base. If good ones come between them, a second device sends with the
/// same address: its packets are refused until the first one has been silent for a second. The first packet is held
/// until a second one fits it, unless its stamp is the host's time.
///
/// Packets without a stamp are released as they arrive. Pure; one thread. Stamps in us.
class PacketOrder {
 public:
  static constexpr int kAgreeing = 10;
  static constexpr std::size_t kMaxHeld = 2;

  /// The buffer to decode the next packet into.
  [[nodiscard]] DecodedPacket& spare() { return slots_[spare_].points; }
  /// Accepts the decoded packet, or returns the reason of its refusal.
  [[nodiscard]] Refusal take(std::int64_t received);
  /// The packet that was just accepted: valid until next().
  [[nodiscard]] PendingPacket& taken() { return slots_[taken_]; }
  /// Whether that packet arrived in its turn, so that its time of receipt shows the delay.
  [[nodiscard]] bool in_order() const { return in_order_; }
  /// Whether the latest packet began a new base: what was learnt of the device's clock is no longer valid.
  [[nodiscard]] bool restarted() const { return restarted_; }
  /// Number of packets that were accepted and then found wrong since the last call: the first packet, if the second
  /// contradicts it.
  [[nodiscard]] int discarded();
  /// A packet of the device was refused elsewhere: it was received, so it is not lost.
  void refused();

  /// The next packet in order that may be published; nullptr if there is none. Valid until take().
  [[nodiscard]] PendingPacket* next();
  /// Releases the held packets without waiting for others.
  void flush() { draining_ = held_count_ > 0; }
  [[nodiscard]] bool has_held() const { return held_count_ > 0; }

  /// How often the device's clock (or head) was found to have moved permanently.
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
  [[nodiscard]] bool base_is_the_odd_one(const Mark& packet) const;
  [[nodiscard]] Refusal take_without_stamp();
  [[nodiscard]] Refusal handle_misfit(const Mark& packet, Refusal why);
  [[nodiscard]] Refusal duplicate_or_late(const Mark& packet) const;
  [[nodiscard]] bool due(const PendingPacket& packet) const;
  [[nodiscard]] long missing(const Mark& before, const Mark& packet) const;
  void hold();
  void discard_held();

  std::array<PendingPacket, kMaxHeld + 3> slots_;
  std::size_t spare_ = 0;
  std::size_t taken_ = 0;
  std::array<std::size_t, kMaxHeld + 1> held_{};  ///< slots, by stamp
  std::size_t held_count_ = 0;

  std::optional<Mark> base_;         ///< the newest accepted packet
  std::optional<Mark> before_base_;  ///< the one before it
  bool confirmed_ = false;           ///< a second packet fitted the first
  std::optional<Mark> sent_;
  std::optional<Mark> misfit_;  ///< the newest packet that did not fit
  int discarded_ = 0;
  int misfits_ = 0;    ///< in a row, fitting each other
  int others_ = 0;     ///< misfits that continue each other, whatever came between
  int stampless_ = 0;  ///< in a row
  int refused_ = 0;    ///< packets since the latest released one
  int sent_since_refused_ = 0;
  bool draining_ = false;
  bool restarted_ = false;
  bool in_order_ = true;
  std::int64_t jumps_ = 0;
};

}  // namespace curbstone::lidar::decoding
