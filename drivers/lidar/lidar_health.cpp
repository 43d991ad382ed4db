#include "drivers/lidar/lidar_health.hpp"

#include <fmt/format.h>

namespace curbstone::lidar {

std::string remedy(decoding::Refusal why, const models::ModelTable& model) {
  using decoding::Refusal;
  switch (why) {
    case Refusal::kLength:
      return fmt::format("their length is none of a {}'s; is another device sending to this port?", model.title);
    case Refusal::kMagic:
      return fmt::format("not {} packets; is another device sending to this port?", model.title);
    case Refusal::kMode:
      return "the device is set to a return mode that is not known, or has not sent it: let it send its information";
    case Refusal::kNoAngles:
      return "the device has not sent its lasers' angles; give them in angles_file, or let it send its information";
    case Refusal::kOtherDevice:
      return "two devices send with one address: give each its own";
    case Refusal::kStamp:
      return "the device's stamps do not go on evenly";
    case Refusal::kAzimuth:
      return "the head stands, or cannot have turned as the packets say";
    default:
      return "damaged packets";
  }
}

void LidarHealth::Watched::look(std::int64_t count, std::int64_t now) {
  silence.tick(now);
  if (count != seen) silence.heard();
  seen = count;
}

void LidarHealth::tick(std::int64_t now) {
  used_watch_.look(used_, now);
  info_watch_.look(info_, now);
  refused_watch_.look(refused_, now);
}

std::vector<std::string> LidarHealth::faults(const models::Model* model) const {
  std::vector<std::string> faults;
  if (is_silent()) {
    const double silent = static_cast<double>(used_watch_.silence.silent()) * 1e-6;
    const bool garbage = refused_ > 0 && refused_watch_.silence.silent() < kSilence;
    faults.push_back(garbage ? fmt::format("no usable packet for {:.1f} s on port {}: {}", silent, msop_port_, remedy_)
                             : fmt::format("no packets for {:.1f} s on port {}", silent, msop_port_));
  } else if (info_is_old() && model != nullptr && model->table().needs_info) {
    const char* angles = model->facts().angles_known         ? ""
                         : model->table().has_nominal_angles ? ": nominal angles are used"
                                                             : ": no angles, so no points";
    faults.push_back(info_ == 0 ? fmt::format("no device information on port {}{}", difop_port_, angles)
                                : fmt::format("no device information for {:.0f} s on port {}",
                                              static_cast<double>(info_watch_.silence.silent()) * 1e-6, difop_port_));
  }
  return faults;
}

}  // namespace curbstone::lidar
