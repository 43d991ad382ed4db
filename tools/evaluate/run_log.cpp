#include "tools/evaluate/run_log.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <curbstone/semantic_tile_t.hpp>
#include <curbstone/service_status_t.hpp>
#include <vector>

#include "common/log/log_reader.hpp"
#include "common/log/message_order.hpp"
#include "common/tile.hpp"
#include "tools/evaluate/quantile.hpp"

namespace curbstone {

namespace {

bool is_driver(const std::string& service) {
  return service == "rslidar" || service == "imu" || service == "encoder";
}

/// A driver refuses what the sensor sent: that is lost. A service refuses an answer (a revolution that does not
/// register, say): nothing was lost on the way, and it says so elsewhere; but a message that does not decode is.
bool is_loss(const std::string& service, const std::string& counter) {
  if (counter.starts_with("dropped.") || counter.starts_with("lost.")) return true;
  return is_driver(service) ? counter.starts_with("refused.") : counter == "refused.undecodable";
}

/// The statuses of one process, first and last: a respawned one counts anew.
struct ProcessSpan {
  service_status_t first;
  service_status_t last;
};

bool decode_status(const LogEvent& event, service_status_t& status) {
  try {
    return status.decode(event.bytes.data(), 0, static_cast<int>(event.bytes.size())) >= 0;
  } catch (const std::exception&) {
    return false;  // lcm-gen 1.3.1 throws on a negative array length
  }
}

/// Counts the gaps in what counts up by one a message sent: lidar_points_t.packet, imu_t.sequence, wheels_t.sequence.
class SequenceGaps {
 public:
  void see(const LogEvent& event) {
    constexpr std::size_t kAt = 16;  // after fingerprint and utime
    if (event.bytes.size() < kAt + 4) return;
    std::uint32_t bits = 0;
    for (std::size_t i = kAt; i < kAt + 4; ++i) bits = bits << 8 | event.bytes[i];
    const auto number = static_cast<std::int32_t>(bits);
    if (last_ && number > *last_) missing_ += number - *last_ - 1;  // a smaller one: the driver was started anew
    last_ = number;
  }
  [[nodiscard]] std::int64_t missing() const { return missing_; }

 private:
  std::optional<std::int64_t> last_;
  std::int64_t missing_ = 0;
};

struct Sent {
  std::int64_t log_utime;
  double age_ms;
};

/// The channels between the sensor and the tile.
constexpr std::array kStages = {"LIDAR_POINTS", "ODOMETRY", "MAP_POSE", "MAP_POINTS", "VOTED_POINTS"};

/// Every message of ours opens with its fingerprint and the time of its measurement, us.
std::optional<std::int64_t> utime_of(const LogEvent& event) {
  if (event.bytes.size() < 16) return {};
  std::uint64_t bits = 0;
  for (std::size_t i = 8; i < 16; ++i) bits = bits << 8 | event.bytes[i];
  return static_cast<std::int64_t>(bits);
}

std::optional<RunFigures::Latency> latency_of(const std::vector<Sent>& messages, std::int64_t lidar_end) {
  std::vector<double> ages;
  for (const Sent& message : messages) {
    if (message.log_utime <= lidar_end) ages.push_back(message.age_ms);
  }
  const bool live = std::any_of(ages.begin(), ages.end(), [](double ms) { return ms > 0; });
  if (!live) return std::nullopt;
  return RunFigures::Latency{quantile(ages, 0.5), quantile(ages, 0.95), static_cast<int>(ages.size())};
}

}  // namespace

RunFigures read_run_log(const std::string& file) {
  LogReader reader(file);
  std::map<std::pair<std::string, int>, ProcessSpan> processes;
  std::vector<Sent> tiles;
  std::map<std::string, std::vector<Sent>> stages;
  std::map<TileKey, std::int64_t> shown;  // us, the newest measurement that a tile has shown
  std::map<std::string, SequenceGaps> gaps = {{"LIDAR_POINTS", {}}, {"IMU", {}}, {"WHEELS", {}}};
  std::int64_t lidar_end = 0;
  while (const auto event = reader.next()) {
    if (std::find(kStages.begin(), kStages.end(), event->channel) != kStages.end()) {
      if (const auto utime = utime_of(*event))
        stages[event->channel].push_back({event->log_utime, 1e-3 * static_cast<double>(event->log_utime - *utime)});
    }
    if (const auto counted = gaps.find(event->channel); counted != gaps.end()) {
      counted->second.see(*event);
      if (event->channel == "LIDAR_POINTS") lidar_end = event->log_utime;
    } else if (event->channel == "SEMANTIC_TILE") {
      semantic_tile_t tile;
      if (tile.decode(event->bytes.data(), 0, static_cast<int>(event->bytes.size())) < 0) continue;
      // A tile that is sent again for its neighbours' sake shows nothing that was measured since.
      std::int64_t& newest = shown[{tile.tile_x, tile.tile_y}];
      if (tile.utime <= newest) continue;
      newest = tile.utime;
      tiles.push_back({event->log_utime, 1e-3 * static_cast<double>(event->log_utime - tile.utime)});
    } else if (event->channel == "SERVICE_STATUS") {
      service_status_t status;
      if (!decode_status(*event, status)) continue;
      const auto [it, is_new] = processes.try_emplace({status.service, status.pid});
      if (is_new) it->second.first = status;
      // Work after the drive is not the cost of driving; losses count to the end.
      const bool driving = lidar_end == 0 || event->log_utime - lidar_end < 1'500'000;
      if (driving) {
        it->second.last = status;
      } else {
        it->second.last.counter_name = status.counter_name;
        it->second.last.counter_value = status.counter_value;
      }
    }
  }

  RunFigures figures;
  std::int64_t full_buffers = 0;  // a process that filters cannot tell its own drops from the host's: see LcmSocket
  figures.processes = static_cast<int>(processes.size());
  for (const auto& [id, span] : processes) {
    const std::string& service = id.first;
    const auto uptime = static_cast<double>(span.last.uptime - span.first.uptime);
    if (uptime > 0) figures.cores[service] = static_cast<double>(span.last.cpu_time - span.first.cpu_time) / uptime;
    for (std::size_t i = 0; i < span.last.counter_name.size(); ++i) {
      const std::string& name = span.last.counter_name[i];
      const std::int64_t value = span.last.counter_value[i];
      if (!is_loss(service, name) || value == 0) continue;
      if (service == "recorder") {
        figures.lost_by_recorder[name] += value;
        continue;
      }
      figures.losses[service + " " + name] += value;
      if (name == "dropped.kernel") {
        full_buffers = std::max(full_buffers, value);
        continue;
      }
      const bool on_the_bus = name == "dropped.queue" || !is_driver(service);
      (on_the_bus ? figures.lost_messages : figures.lost_packets) += value;
    }
  }
  figures.lost_messages += full_buffers;
  for (const auto& [channel, seen] : gaps) {
    std::int64_t missing = seen.missing();
    // The IMU counts its own packets: what its driver did not get either was lost on the wire.
    if (channel == "IMU") missing -= figures.losses["imu lost.packets"];
    if (missing > 0) figures.lost_by_recorder[channel] = missing;
  }
  std::erase_if(figures.losses, [](const auto& entry) { return entry.second == 0; });
  figures.latency = latency_of(tiles, lidar_end);
  for (const auto& [channel, messages] : stages) {
    if (const auto latency = latency_of(messages, lidar_end)) figures.stages[channel] = *latency;
  }
  return figures;
}

}  // namespace curbstone
