#include "services/mapper/scan/scan_assembler.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace curbstone::mapper::scan {
namespace {

constexpr int kPackets = 8;             // of a scan, at least, to tell by its stamps
constexpr std::int64_t kShare = 20;     // of a revolution
constexpr float kMaxTimeOffset = 0.1F;  // s; a packet of the slowest revolution lasts 5 ms

bool well_formed(const lidar_points_t& m) {
  const auto n = static_cast<std::size_t>(std::max(m.num_points, 0));
  return m.num_points >= 0 && m.utime > 0 && m.x.size() == n && m.y.size() == n && m.z.size() == n &&
         m.time_offset.size() == n && m.intensity.size() == n && m.ring.size() == n;
}

}  // namespace

std::optional<Scan> ScanAssembler::add(const lidar_points_t& packet) {
  counters_.add("lidar.packets");
  if (!well_formed(packet)) {
    counters_.add("refused.packet");
    return std::nullopt;
  }
  if (!current_) return restart_with(packet);

  const std::int64_t ahead = packet.utime - newest_utime_;
  // A packet with the next sequence number and an earlier stamp was not overtaken: the clock was set back.
  const bool set_back = packet.packet == newest_packet_ + 1 && ahead < -limits_.set_back;
  if (std::abs(ahead) > limits_.clock_jump || set_back) {
    counters_.add("lidar.clock_jumps");
    return restart_with(packet);
  }
  if (packet.packet <= newest_packet_ && ahead > 0) {  // newer, but with a lower sequence number: the driver restarted
    counters_.add("lidar.restarts");
    return restart_with(packet);
  }
  if (packet.packet <= newest_packet_) {
    take_late(packet);
    return std::nullopt;
  }

  const std::int64_t lost = std::int64_t{packet.packet} - newest_packet_ - 1;
  counters_.add("lidar.lost", lost);
  current_->lost += lost;
  if (packet.revolution != current_->number) return restart_with(packet);
  if (packet.utime - current_->start > limits_.max_span ||
      current_->points.size() + packet.x.size() > limits_.max_points) {
    counters_.add("refused.endless_scan");
    return restart_with(packet);
  }
  append(packet);
  return std::nullopt;
}

void ScanAssembler::take_late(const lidar_points_t& packet) {
  if (std::find(seen_.begin(), seen_.end(), packet.packet) != seen_.end()) return counters_.add("dropped.duplicate");
  if (packet.revolution != current_->number || packet.utime < current_->start) return counters_.add("dropped.late");
  counters_.add("lidar.reordered");
  --current_->lost;
  append(packet);
}

std::optional<Scan> ScanAssembler::flush() {
  return std::exchange(current_, std::nullopt);
}

std::optional<Scan> ScanAssembler::restart_with(const lidar_points_t& packet) {
  std::optional<Scan> done = flush();
  if (done) check_stamps(*done, packet.utime);
  current_.emplace();
  current_->number = packet.revolution;
  current_->start = current_->end = packet.utime;
  if (done) current_->points.reserve(done->points.size() + 1024);
  seen_.clear();
  newest_utime_ = packet.utime;
  newest_packet_ = packet.packet;
  append(packet);
  return done;
}

/// A LiDAR takes its points over all of the revolution, but where it sends a small part of the view.
void ScanAssembler::check_stamps(const Scan& done, std::int64_t next_start) {
  const std::int64_t period = next_start - done.start;
  const bool is_revolution = done.packets >= kPackets && period > 0 && period <= limits_.max_span;
  if (!is_revolution || kShare * (done.end - done.start) >= period) {
    with_one_stamp_ = 0;
    return;
  }
  counters_.add("lidar.one_stamp");
  ++with_one_stamp_;
}

void ScanAssembler::append(const lidar_points_t& packet) {
  Scan& scan = *current_;
  const float base = static_cast<float>(static_cast<double>(packet.utime - scan.start) * 1e-6);
  const auto min2 = static_cast<float>(limits_.min_range * limits_.min_range);
  const auto max2 = static_cast<float>(limits_.max_range * limits_.max_range);
  float last = 0;
  std::int64_t not_finite = 0;
  std::int64_t out_of_range = 0;
  for (std::size_t i = 0; i < packet.x.size(); ++i) {
    const Eigen::Vector3f p(packet.x[i], packet.y[i], packet.z[i]);
    const float range2 = p.squaredNorm();
    const float offset = packet.time_offset[i];
    if (!std::isfinite(range2) || !(offset >= 0 && offset <= kMaxTimeOffset)) {
      ++not_finite;
    } else if (range2 < min2 || range2 > max2) {
      ++out_of_range;
    } else {
      last = std::max(last, offset);
      scan.points.push_back({p, base + offset, packet.intensity[i], packet.ring[i]});
    }
  }
  if (not_finite > 0) counters_.add("refused.not_finite", not_finite);
  if (out_of_range > 0) counters_.add("points.out_of_range", out_of_range);
  ++scan.packets;
  scan.end =
      std::max(scan.end, packet.utime + static_cast<std::int64_t>(std::llround(static_cast<double>(last) * 1e6)));
  seen_.push_back(packet.packet);
  newest_utime_ = std::max(newest_utime_, packet.utime);
  newest_packet_ = std::max(newest_packet_, packet.packet);
}

}  // namespace curbstone::mapper::scan
