#include "drivers/lidar/decoding/head_tracker.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::lidar::decoding {

namespace {

constexpr std::int64_t kTurn = 36000;
constexpr std::int64_t kJitter = 100;  // 0.01 deg; a larger backward step is a packet that was overtaken
constexpr double kLateAtMost = 0.1;    // s; a larger step back in time means that the clock was set
constexpr double kGapAtMost = 10.0;    // s; after a longer silence losses are not estimated

std::int64_t wrapped(std::int64_t angle) {
  return (angle % kTurn + kTurn) % kTurn;
}

}  // namespace

HeadTracker::Step HeadTracker::follow(const Packet& packet, double blind) {
  if (!last_) {
    last_ = packet;
    turned_ = wrapped(packet.azimuth - cut_angle_);
    return {};
  }
  const double elapsed = static_cast<double>(packet.utime - last_->utime) * 1e-6;
  const bool unknown = elapsed < -kLateAtMost || elapsed > kGapAtMost;
  const double per_packet = last_->rate * last_->duration;
  // The azimuth does not show full revolutions; the time does, approximately.
  const double expected = unknown ? per_packet : elapsed * last_->rate;
  const std::int64_t ahead = wrapped(packet.azimuth - last_->azimuth);
  const std::int64_t turned = ahead + kTurn * std::llround((expected - static_cast<double>(ahead)) / kTurn);

  Step step;
  step.duplicate = ahead == 0 && std::abs(elapsed) < 0.5 * packet.duration;
  step.late = turned < -kJitter;
  if (!step.duplicate && !step.late) {
    const double missing = static_cast<double>(turned) - per_packet - blind;
    if (per_packet >= 1 && !unknown) step.lost = std::max<std::int64_t>(0, std::llround(missing / per_packet));
    turned_ += turned;
    scan_ = std::max(scan_, static_cast<std::int32_t>(std::max<std::int64_t>(0, turned_) / kTurn));
    last_ = packet;
  }
  step.revolution = scan_;
  return step;
}

}  // namespace curbstone::lidar::decoding
