#include "tools/evaluate/run_log.hpp"

#include <algorithm>
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

}  // namespace

namespace {

struct SentTile {
  std::int64_t log_utime;
  double latency_ms;
};

std::optional<RunFigures::Latency> latency_of(const std::vector<SentTile>& tiles, std::int64_t lidar_end) {
  std::vector<double> latencies;
  for (const SentTile& tile : tiles) {
    if (tile.log_utime <= lidar_end) latencies.push_back(tile.latency_ms);
  }
  const bool live = std::any_of(latencies.begin(), latencies.end(), [](double ms) { return ms > 0; });
  if (!live) return std::nullopt;
  return RunFigures::Latency{quantile(latencies, 0.5), quantile(latencies, 0.95), static_cast<int>(latencies.size())};
}

}  // namespace

RunFigures read_run_log(const std::string& file) {
  LogReader reader(file);
  std::map<std::pair<std::string, int>, ProcessSpan> processes;
  std::vector<SentTile> tiles;
  std::map<TileKey, std::int64_t> shown;  // us, the newest measurement that a tile has shown
  std::map<std::string, SequenceGaps> gaps = {{"LIDAR_POINTS", {}}, {"IMU", {}}, {"WHEELS", {}}};
  std::int64_t lidar_end = 0;
  while (const auto event = reader.next()) {
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
      const bool on_the_bus = name == "dropped.queue" || name == "dropped.kernel" || !is_driver(service);
      (on_the_bus ? figures.lost_messages : figures.lost_packets) += value;
    }
  }
  for (const auto& [channel, seen] : gaps) {
    std::int64_t missing = seen.missing();
    // The IMU counts its own packets: what its driver did not get either was lost on the wire.
    if (channel == "IMU") missing -= figures.losses["imu lost.packets"];
    if (missing > 0) figures.lost_by_recorder[channel] = missing;
  }
  std::erase_if(figures.losses, [](const auto& entry) { return entry.second == 0; });
  figures.latency = latency_of(tiles, lidar_end);
  return figures;
}

}  // namespace curbstone
