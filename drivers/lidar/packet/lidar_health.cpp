#include "drivers/lidar/packet/lidar_health.hpp"

#include <fmt/format.h>

namespace curbstone::lidar::packet {

namespace {

constexpr double kSilence = 1.0;      // s without a point packet
constexpr double kInfoSilence = 5.0;  // s without device information, which comes one to ten times a second

const char* remedy(Refusal why) {
  switch (why) {
    case Refusal::kHelios16p:
      return "an RS-Helios-16P is sending; this driver speaks RS-LiDAR-16";
    case Refusal::kDualReturn:
      return "the device is set to dual return; set it to strongest or last";
    case Refusal::kLength:
      return "not 1248 bytes long; is another device sending to this port?";
    case Refusal::kMagic:
      return "not RS-LiDAR-16 packets; is another device sending to this port?";
    default:
      return "damaged packets";
  }
}

}  // namespace

void LidarHealth::Watched::look(std::int64_t count, std::int64_t now) {
  if (count != seen) grew_at = now;
  seen = count;
}

void LidarHealth::tick(std::int64_t now) {
  now_ = now;
  if (!started_) {
    used_watch_.grew_at = info_watch_.grew_at = refused_watch_.grew_at = now;
    started_ = true;
  }
  used_watch_.look(used_, now);
  info_watch_.look(info_, now);
  refused_watch_.look(refused_, now);
}

std::vector<std::string> LidarHealth::faults() const {
  std::vector<std::string> faults;
  const double silent = since(used_watch_.grew_at);
  if (silent >= kSilence) {
    const bool garbage = refused_ > 0 && since(refused_watch_.grew_at) < kSilence;
    faults.push_back(
        garbage ? fmt::format("no usable packet for {:.1f} s on port {}: {}", silent, msop_port_, remedy(last_refusal_))
                : fmt::format("no packets for {:.1f} s on port {}", silent, msop_port_));
  } else if (since(info_watch_.grew_at) >= kInfoSilence) {
    faults.push_back(info_ == 0 ? fmt::format("no device information on port {}: nominal angles are used", difop_port_)
                                : fmt::format("no device information for {:.0f} s on port {}",
                                              since(info_watch_.grew_at), difop_port_));
  }
  return faults;
}

}  // namespace curbstone::lidar::packet
