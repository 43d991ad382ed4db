#include "services/mapper/scan/packet_intake.hpp"

#include <algorithm>
#include <utility>

namespace curbstone::mapper::scan {
namespace {

constexpr std::int64_t kMaxPackets = 100'000;  // a larger step of the sequence numbers is not a loss

bool is_next(std::int32_t number, std::int32_t before) {
  return std::int64_t{number} == std::int64_t{before} + 1;
}

}  // namespace

/// Whether the packet is a later one of the same driver, with missing packets before it that may be requested.
bool PacketIntake::is_gap_before(const lidar_points_t& packet) const {
  if (!last_)
    return begin_after_ && packet.utime > *begin_after_ + 1 &&
           packet.utime - *begin_after_ <= ResendClient::kMaxMissing;
  const std::int64_t step = std::int64_t{packet.packet} - last_->number;
  const std::int64_t ahead = packet.utime - last_->utime;
  return step > 1 && step <= kMaxPackets && ahead > 0 && ahead <= ResendClient::kMaxMissing;
}

bool PacketIntake::is_from_second_lidar(const lidar_points_t& packet) const {
  constexpr std::int32_t kNearEnd = 0x7FFFFFFF - 1000;  // the sequence numbers wrap after it
  return last_ && packet.packet <= last_->number && last_->number < kNearEnd && packet.utime > last_->utime &&
         packet.utime - last_->utime < kRestart;
}

bool PacketIntake::is_of_long_ago(const lidar_points_t& packet) const {
  return last_ && !is_next(packet.packet, last_->number) && last_->utime - packet.utime > kLongAgo;
}

/// Drops held packets of another driver: the packet follows the last one that was passed on and is later than packets
/// that wait behind a gap with higher numbers, so those are not of the same driver.
void PacketIntake::drop_held_of_second_lidar(const lidar_points_t& packet) {
  if (!last_ || packet.packet <= last_->number || packet.utime <= last_->utime) return;
  while (!held_.empty() && held_.back().packet > packet.packet && held_.back().utime < packet.utime) {
    second_lidar_ = held_.back().utime;
    held_.pop_back();
    counters_.add("refused.second_lidar");
  }
}

void PacketIntake::add(const lidar_points_t& packet, const Handler& handler) {
  if (packet.utime <= 0) return handler(packet);  // the receiver refuses it
  if (!is_of_long_ago(packet)) {
    long_ago_ = 0;
  } else if (long_ago_ + 1 < kClockWasSet) {
    ++long_ago_;
    refused_ = last_->utime;
    return counters_.add("refused.second_lidar");
  }
  newest_ = packet.utime;
  if (is_from_second_lidar(packet)) {
    refused_ = packet.utime;
    return counters_.add("refused.second_lidar");
  }
  drop_held_of_second_lidar(packet);
  if (is_gap_before(packet) && !client_.is_deaf(packet.utime)) {
    if (held_.empty()) waited_ = 0;
    return hold(packet);
  }
  const bool is_late = last_ && packet.packet <= last_->number && packet.utime <= last_->utime;
  if (is_late) return handler(packet);  // a duplicate, or overtaken by later packets
  if (!last_ || !is_next(packet.packet, last_->number)) release(handler);
  pass(packet, handler);
  pass_held(handler);
}

void PacketIntake::add_resent(const lidar_points_t& packet, const Handler& handler) {
  if (held_.empty() || packet.utime <= 0) return;
  const lidar_points_t& newest = held_.back();
  const bool is_missing =
      packet.packet < newest.packet && packet.utime < newest.utime &&
      (last_ ? packet.packet > last_->number && packet.utime > last_->utime : packet.utime > begin_after_.value_or(0));
  if (!is_missing || holds(packet.packet)) return;
  client_.answered();
  counters_.add("lidar.resent");
  waited_ = 0;
  if (last_ && !is_next(packet.packet, last_->number)) {
    hold(packet);
  } else {
    pass(packet, handler);
    pass_held(handler);
  }
  client_.ask(ticked_, missing());  // for the next gap
}

/// The first held packet with this sequence number or a later one.
std::deque<lidar_points_t>::iterator PacketIntake::place_of(std::int32_t number) {
  const auto by_number = [](const lidar_points_t& held, std::int32_t n) { return held.packet < n; };
  return std::lower_bound(held_.begin(), held_.end(), number, by_number);
}

bool PacketIntake::holds(std::int32_t number) {
  const auto place = place_of(number);
  return place != held_.end() && place->packet == number;
}

void PacketIntake::hold(const lidar_points_t& packet) {
  if (holds(packet.packet)) return;
  if (held_.size() >= kMaxHeld) {
    if (packet.packet > held_.back().packet) return;
    held_.pop_back();
  }
  held_.insert(place_of(packet.packet), packet);
}

void PacketIntake::pass(const lidar_points_t& packet, const Handler& handler) {
  const bool same_driver = last_ && packet.packet > last_->number;
  if (refused_ != 0 && packet.utime > refused_) {
    if (same_driver) second_lidar_ = refused_;
    refused_ = 0;
  }
  last_ = Last{packet.packet, packet.utime};
  handler(packet);
}

void PacketIntake::pass_held(const Handler& handler) {
  while (!held_.empty() && last_ && held_.front().packet <= last_->number + std::int64_t{1}) {
    const lidar_points_t packet = std::move(held_.front());
    held_.pop_front();
    if (packet.packet > last_->number) pass(packet, handler);
  }
}

void PacketIntake::tick(std::int64_t now, const Handler& handler) {
  if (!held_.empty()) {
    if (waited_ >= kPatience) give_up(handler);
    waited_ += ResendClient::waited(now, ticked_);
  }
  client_.ask(ticked_ = now, missing());
}

/// Gives up one gap; further gaps may follow behind it.
void PacketIntake::give_up(const Handler& handler) {
  client_.gave_up(newest_);
  counters_.add("lidar.not_resent");
  waited_ = 0;
  const lidar_points_t packet = std::move(held_.front());
  held_.pop_front();
  pass(packet, handler);
  pass_held(handler);
}

void PacketIntake::release(const Handler& handler) {
  while (!held_.empty()) {
    const lidar_points_t packet = std::move(held_.front());
    held_.pop_front();
    pass(packet, handler);
  }
}

void PacketIntake::add_faults(std::vector<std::string>& faults) const {
  if (second_lidar_ != 0 && newest_ - second_lidar_ < 1'000'000)
    faults.emplace_back(
        "two LiDARs send on LIDAR_POINTS, and one is mapped: give the other a `channel` of its own, or "
        "end the log that is played into the bus");
}

std::optional<MissingMessages> PacketIntake::missing() const {
  if (held_.empty()) return std::nullopt;
  return MissingMessages{last_ ? last_->utime : begin_after_.value_or(0), held_.front().utime};
}

}  // namespace curbstone::mapper::scan
