#include "drivers/lidar/decoding/packet_order.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace curbstone::lidar::decoding {

namespace {

constexpr double kFullCircle = 36000;       // 0.01 deg
constexpr double kReorderAtMost = 100'000;  // us by which a packet may arrive after a later one
constexpr double kShortGap = 500'000;       // us, within which the head's speed is constant
constexpr double kReceiptJitter = 40'000;   // us, of the time of receipt
constexpr double kLongGapJitter = 250'000;  // us, the same after a longer silence
constexpr double kClocksAgree = 20'000;     // us; clocks do not agree to this by chance
constexpr int kForgetRefusedAfter = 3;      // packets
constexpr std::int64_t kGone = 1'000'000;   // us without a packet, after which a second device is followed

double nearest_turn(double angle) {
  return angle - kFullCircle * std::round(angle / kFullCircle);
}

}  // namespace

PacketOrder::Mark PacketOrder::mark(const PendingPacket& packet) {
  return {packet.points.stamp.value_or(0), packet.received, packet.points.azimuth, packet.points.rate * 1e-6,
          packet.points.duration * 1e6};
}

/// A packet begins when the previous one ends, within the tolerance of firmware with other firing times. One that
/// begins in the middle of another was decoded in the wrong return mode.
bool PacketOrder::overlap(const Mark& before, const Mark& packet) {
  const std::int64_t passed = packet.stamp - before.stamp;
  const double part = std::abs(static_cast<double>(passed)) / (passed > 0 ? before.duration : packet.duration);
  return part > 0.2 && part < 0.8;
}

/// A head is heavy. If its speed changes at once, the packet was decoded in the wrong return mode, too.
bool PacketOrder::other_speed(const Mark& before, const Mark& packet) {
  const auto [slow, fast] = std::minmax({std::abs(before.rate), std::abs(packet.rate)});
  return fast > 1.4 * slow;
}

Refusal PacketOrder::fits(const Mark& before, const Mark& packet) {
  const auto passed = static_cast<double>(packet.stamp - before.stamp);
  const double beside_receipt = std::abs(passed - static_cast<double>(packet.received - before.received));
  if (passed < -kReorderAtMost || overlap(before, packet)) return Refusal::kStamp;
  if (other_speed(before, packet)) return Refusal::kAzimuth;
  if (passed > kShortGap) return beside_receipt <= kLongGapJitter ? Refusal::kNone : Refusal::kStamp;
  // Times of receipt may be arbitrary while the stamps continue without a gap: a busy host, a network that was blocked.
  const bool near = std::abs(passed) <= 4 * before.duration;
  if (!near && beside_receipt > kReceiptJitter) return Refusal::kStamp;

  const double turned = 0.5 * (before.rate + packet.rate) * passed;
  const double off = std::abs(nearest_turn(packet.azimuth - before.azimuth - turned));
  const double tolerance = 30 + 0.25 * std::abs(before.rate) * before.duration + 0.02 * std::abs(turned);
  if (off <= tolerance) return Refusal::kNone;
  const double whole = std::round(passed / before.duration) * before.duration;
  const bool goes_on = packet.stamp != before.stamp;
  const bool on_time = std::abs(passed - whole) < 0.1 * before.duration && beside_receipt <= kReceiptJitter && goes_on;
  return on_time ? Refusal::kAzimuth : Refusal::kStamp;
}

/// A stamp that is wrong by less than the tolerance is accepted, and the next good packet does not fit it. But it is a
/// whole number of packets after the one before, as the wrong one is not.
bool PacketOrder::base_is_the_odd_one(const Mark& packet) const {
  if (!confirmed_ || !before_base_) return false;
  const auto is_whole = [&](const Mark& mark) {
    const double packets = static_cast<double>(mark.stamp - before_base_->stamp) / before_base_->duration;
    return packets > 0.5 && std::abs(packets - std::round(packets)) < 0.1;
  };
  return !is_whole(*base_) && is_whole(packet) && fits(*before_base_, packet) == Refusal::kNone;
}

Refusal PacketOrder::take(std::int64_t received) {
  PendingPacket& packet = slots_[spare_];
  packet.received = received;
  restarted_ = false;
  if (!packet.points.stamp) return take_without_stamp();
  stampless_ = 0;

  const Mark now = mark(packet);
  const bool waiting = confirmed_ && held_count_ > 0;
  if (base_) {
    const Refusal why = fits(*base_, now);
    if (why != Refusal::kNone && !base_is_the_odd_one(now)) {
      if (const Refusal refusal = handle_misfit(now, why); refusal != Refusal::kNone) return refusal;
    } else {
      misfits_ = 0;
      if (const Refusal refusal = duplicate_or_late(now); refusal != Refusal::kNone) return refusal;
      confirmed_ = true;
    }
  }
  if (!base_) {
    const double delay = static_cast<double>(received - now.stamp) - now.duration;
    confirmed_ = std::abs(delay) <= kClocksAgree;
  }
  const long ahead = base_ && !restarted_ ? missing(*base_, now) : 0;
  in_order_ = !waiting && (ahead == 0 || ahead > static_cast<long>(kMaxHeld));
  if (!base_ || restarted_ || now.stamp > base_->stamp) {
    before_base_ = restarted_ ? std::nullopt : base_;
    base_ = now;
  }
  hold();
  return Refusal::kNone;
}

Refusal PacketOrder::take_without_stamp() {
  if (base_ && ++stampless_ < kAgreeing) {
    refused();
    return Refusal::kStamp;
  }
  base_.reset();
  before_base_.reset();
  sent_.reset();
  in_order_ = true;
  hold();
  draining_ = true;
  return Refusal::kNone;
}

Refusal PacketOrder::handle_misfit(const Mark& packet, Refusal why) {
  const bool goes_on = misfit_ && fits(*misfit_, packet) == Refusal::kNone;
  misfits_ = goes_on && misfits_ > 0 ? misfits_ + 1 : 1;
  const bool at_once = goes_on && static_cast<double>(packet.stamp - misfit_->stamp) <= 4 * packet.duration;
  others_ = at_once ? others_ + 1 : 0;
  misfit_ = packet;
  if (!confirmed_) {
    // One of the first two is wrong. The first has not been released; the next packet decides.
    discard_held();
    restarted_ = true;
    return Refusal::kNone;
  }
  const bool between_good_ones = others_ >= std::max(kAgreeing, misfits_);
  if (between_good_ones && packet.received - base_->received < kGone) return Refusal::kOtherDevice;
  if (misfits_ < kAgreeing) {
    refused();
    return why;
  }
  ++jumps_;
  misfits_ = others_ = 0;
  misfit_.reset();
  restarted_ = true;
  sent_.reset();
  draining_ = held_count_ > 0;
  return Refusal::kNone;
}

Refusal PacketOrder::duplicate_or_late(const Mark& packet) const {
  const auto same = [&](const Mark& other) {
    return packet.azimuth == other.azimuth &&
           std::abs(static_cast<double>(packet.stamp - other.stamp)) < 0.5 * packet.duration;
  };
  bool duplicate = sent_ && same(*sent_);
  for (std::size_t i = 0; i < held_count_; ++i) duplicate = duplicate || same(mark(slots_[held_[i]]));
  if (duplicate) return Refusal::kDuplicate;
  return sent_ && packet.stamp <= sent_->stamp ? Refusal::kLate : Refusal::kNone;
}

void PacketOrder::hold() {
  taken_ = spare_;
  std::size_t at = held_count_++;
  for (; at > 0 && slots_[held_[at - 1]].points.stamp > slots_[taken_].points.stamp; --at) held_[at] = held_[at - 1];
  held_[at] = taken_;
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
    const auto end = held_.begin() + static_cast<std::ptrdiff_t>(held_count_);
    if (std::find(held_.begin(), end, slot) == end) spare_ = slot;
  }
  if (held_count_ > kMaxHeld) draining_ = true;
}

void PacketOrder::discard_held() {
  discarded_ += static_cast<int>(held_count_);
  held_count_ = 0;
  draining_ = false;
}

bool PacketOrder::due(const PendingPacket& packet) const {
  if (draining_) return true;
  if (!confirmed_) return false;
  if (!sent_) return true;
  const long before = missing(*sent_, mark(packet));
  return before <= 0 || before > static_cast<long>(kMaxHeld);
}

/// Number of packets missing between the two; negative if the second was fired first.
long PacketOrder::missing(const Mark& before, const Mark& packet) const {
  const double gap = static_cast<double>(packet.stamp - before.stamp) - before.duration;
  const long packets = std::lround(gap / before.duration);
  return packets > 0 ? std::max(packets - refused_, 0L) : packets;
}

PendingPacket* PacketOrder::next() {
  if (held_count_ == 0) draining_ = false;
  if (held_count_ == 0 || !due(slots_[held_[0]])) return nullptr;
  PendingPacket& packet = slots_[held_[0]];
  --held_count_;
  std::copy_n(held_.begin() + 1, held_count_, held_.begin());
  packet.refused_before = refused_;
  if (++sent_since_refused_ >= kForgetRefusedAfter) refused_ = 0;
  if (packet.points.stamp) sent_ = mark(packet);
  return &packet;
}

int PacketOrder::discarded() {
  return std::exchange(discarded_, 0);
}

void PacketOrder::refused() {
  ++refused_;
  sent_since_refused_ = 0;
}

}  // namespace curbstone::lidar::decoding
