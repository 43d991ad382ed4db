#include "drivers/lidar/decoding/packet_clock.hpp"

#include <cstdlib>

namespace curbstone::lidar::decoding {

PacketClock::Time PacketClock::time_of(std::optional<std::int64_t> stamp, std::int64_t received, std::int64_t duration,
                                       bool host_is_synchronised, bool in_order) {
  const bool offset_known = stamped_;
  const std::int64_t fired = received - duration;
  stamped_ = stamp.has_value();
  if (!stamp) {
    choose(false);
    return {fired, fired};
  }
  choose(host_is_synchronised && std::abs(*stamp - fired) <= tolerance_);
  const std::int64_t host_utime =
      in_order || !offset_known ? offset_.to_host(*stamp, fired) : *stamp + offset_.offset();
  return {uses_device_ ? *stamp : host_utime, host_utime};
}

std::optional<std::int64_t> PacketClock::difference() const {
  if (!stamped_) return std::nullopt;
  return -offset_.offset();
}

void PacketClock::choose(bool device_is_sane) {
  const bool wanted = mode_ == ClockMode::kDevice || (mode_ == ClockMode::kAuto && device_is_sane);
  if (!decided_) {
    decided_ = true;
    if (contrary_count_ == kRestarted && wanted != uses_device_) ++switches_;
    contrary_count_ = 0;
    uses_device_ = wanted;
    return;
  }
  contrary_count_ = wanted == uses_device_ ? 0 : contrary_count_ + 1;
  if (contrary_count_ < kPatience) return;
  contrary_count_ = 0;
  uses_device_ = wanted;
  ++switches_;
}

}  // namespace curbstone::lidar::decoding
