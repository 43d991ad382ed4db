#include "tools/evaluate/run_log.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <curbstone/imu_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <curbstone/semantic_tile_t.hpp>
#include <curbstone/service_status_t.hpp>
#include <curbstone/voted_points_t.hpp>
#include <curbstone/wheels_t.hpp>
#include <functional>
#include <utility>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/bus/harmless_counters.hpp"
#include "common/bus/single_sender.hpp"
#include "common/log/log_reader.hpp"
#include "common/statistics/quantile.hpp"
#include "common/tiles/tile.hpp"
#include "tools/output/watched_log.hpp"

namespace curbstone::evaluate {

namespace {

constexpr double kMoved = 0.05;                    // m
constexpr std::int64_t kFirstMinute = 60'000'000;  // us

bool is_driver(const std::string& service) {
  return service == "lidar" || service == "rslidar" || service == "imu" || service == "encoder";
}

/// A driver's refused packet counts as lost, because the sensor sent it. A service's refusal (for example of a
/// revolution that does not register) is no loss in transit and is reported elsewhere; but a message that does not
/// decode is a loss.
bool is_loss(const std::string& service, const std::string& counter) {
  if (is_harmless(counter)) return false;
  if (counter.starts_with("dropped.") || counter.starts_with("lost.")) return true;
  return is_driver(service) ? counter.starts_with("refused.") : counter == "refused.undecodable";
}

/// The first and the last status of one process; a respawned process is counted separately.
struct ProcessSpan {
  service_status_t first;
  service_status_t last;
  std::int64_t own_kb = 0;                    ///< its memory.own_kb at the end of the drive
  std::optional<std::int64_t> minute_own_kb;  ///< likewise, at its first status after the first minute
};

std::int64_t counter_of(const service_status_t& status, const char* name) {
  const auto at = std::find(status.counter_name.begin(), status.counter_name.end(), name);
  return at == status.counter_name.end()
             ? 0
             : status.counter_value[static_cast<std::size_t>(at - status.counter_name.begin())];
}

/// Counts the gaps in sequence numbers that increase by one per message: lidar_points_t.packet, imu_t.sequence,
/// wheels_t.sequence. The numbers of a second sender, such as a log that was played into the bus, are left out.
class SequenceGaps {
 public:
  void see(std::int64_t utime, std::int32_t number) {
    if (!sender_.accept(utime, number)) return;
    if (last_ && number > *last_) missing_ += number - *last_ - 1;  // a smaller one: the driver was restarted
    last_ = number;
  }
  [[nodiscard]] std::int64_t missing() const { return missing_; }

 private:
  SingleSender sender_;
  std::optional<std::int64_t> last_;
  std::int64_t missing_ = 0;
};

struct Sent {
  std::int64_t log_utime;
  double age_ms;
};

/// When a message was logged, and the age of its measurement then. Times in us.
Sent sent(std::int64_t log_utime, std::int64_t utime) {
  return {log_utime, 1e-3 * static_cast<double>(log_utime - utime)};
}

std::optional<RunFigures::Latency> latency_of(const std::vector<Sent>& messages, std::int64_t lidar_end) {
  std::vector<double> ages;
  for (const Sent& message : messages) {
    if (message.log_utime <= lidar_end) ages.push_back(message.age_ms);
  }
  const bool live = std::any_of(ages.begin(), ages.end(), [](double ms) { return ms > 0; });
  if (!live) return std::nullopt;
  return RunFigures::Latency{quantile_in_place(ages, 0.5), quantile_in_place(ages, 0.95), quantile_in_place(ages, 0.99),
                             *std::max_element(ages.begin(), ages.end()), static_cast<int>(ages.size())};
}

/// Collects the messages of a recording, in the order in which they were logged.
class Recording {
 public:
  Recording() {
    on<lidar_points_t>("LIDAR_POINTS", [this](const lidar_points_t& points, std::int64_t log_utime) {
      passed("LIDAR_POINTS", points.utime, log_utime);
      gaps["LIDAR_POINTS"].see(points.utime, points.packet);
      lidar_end = log_utime;
    });
    on<imu_t>("IMU", [this](const imu_t& imu, std::int64_t) { gaps["IMU"].see(imu.utime, imu.sequence); });
    on<wheels_t>("WHEELS",
                 [this](const wheels_t& wheels, std::int64_t) { gaps["WHEELS"].see(wheels.utime, wheels.sequence); });
    on_stage<odometry_t>("ODOMETRY");
    on<map_pose_t>("MAP_POSE", [this](const map_pose_t& pose, std::int64_t log_utime) {
      passed("MAP_POSE", pose.utime, log_utime);
      posed(pose, log_utime);
    });
    on_stage<map_points_t>("MAP_POINTS");
    on_stage<voted_points_t>("VOTED_POINTS");
    on<semantic_tile_t>("SEMANTIC_TILE", [this](const auto& tile, std::int64_t log_utime) { shown(tile, log_utime); });
    on<service_status_t>("SERVICE_STATUS",
                         [this](const auto& status, std::int64_t log_utime) { reported(status, log_utime); });
  }
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  /// Messages that do not decode are ignored.
  void take(const LogEvent& event) {
    if (const auto handler = handlers_.find(event.channel); handler != handlers_.end()) handler->second(event);
  }

  std::map<std::pair<std::string, int>, ProcessSpan> processes;
  std::vector<Sent> tiles;                          ///< those with new measurements
  std::map<std::string, std::vector<Sent>> stages;  ///< by channel between the sensor and the tile
  std::map<std::string, SequenceGaps> gaps;         ///< by channel with sequence numbers
  std::int64_t lidar_end = 0;                       ///< us, when the last LIDAR_POINTS was logged
  std::map<std::string, std::int64_t> first;        ///< us, when the first message of a stage, or a tile, was logged
  std::optional<std::int64_t> set_off;              ///< us

 private:
  template <class Message>
  void on(const char* channel, std::function<void(const Message&, std::int64_t log_utime)> handler) {
    handlers_[channel] = [handler = std::move(handler), message = Message{}](const LogEvent& event) mutable {
      if (decode(event.bytes.data(), static_cast<int>(event.bytes.size()), message)) handler(message, event.log_utime);
    };
  }
  template <class Message>
  void on_stage(const char* channel) {
    on<Message>(channel, [this, channel](const Message& message, std::int64_t log_utime) {
      passed(channel, message.utime, log_utime);
    });
  }
  void passed(const char* channel, std::int64_t utime, std::int64_t log_utime) {
    stages[channel].push_back(sent(log_utime, utime));
    first.emplace(channel, log_utime);
  }
  void posed(const map_pose_t& pose, std::int64_t log_utime) {
    const Eigen::Map<const Eigen::Vector3d> position(pose.map_base_position);
    if (!began_at_) began_at_ = position;
    if (!set_off && (position - *began_at_).norm() > kMoved) set_off = log_utime;
  }
  void shown(const semantic_tile_t& tile, std::int64_t log_utime) {
    first.emplace("SEMANTIC_TILE", log_utime);
    if (epoch_ && tile.epoch != *epoch_) epoch_began_ = log_utime;
    epoch_ = tile.epoch;
    // A tile that is sent again because of its neighbours shows no new measurement. Nor does one that a new epoch has
    // moved: its newest points may be another tile's of before.
    std::int64_t& newest = newest_shown_[{tile.tile_x, tile.tile_y}];
    if (tile.utime <= std::max(newest, epoch_began_)) return;
    newest = tile.utime;
    tiles.push_back(sent(log_utime, tile.utime));
  }
  void reported(const service_status_t& status, std::int64_t log_utime) {
    const auto [it, is_new] = processes.try_emplace({status.service, status.pid});
    if (is_new) it->second.first = status;
    // Work after the drive is not a cost of driving; losses count to the end.
    const bool driving = lidar_end == 0 || log_utime - lidar_end < 1'500'000;
    if (driving) {
      it->second.last = status;
      it->second.own_kb = counter_of(status, "memory.own_kb");
      const auto lidar = first.find("LIDAR_POINTS");
      const bool minute_is_over = lidar != first.end() && log_utime - lidar->second >= kFirstMinute;
      if (minute_is_over && !it->second.minute_own_kb) it->second.minute_own_kb = it->second.own_kb;
    } else {
      it->second.last.counter_name = status.counter_name;
      it->second.last.counter_value = status.counter_value;
    }
  }

  std::map<std::string, std::function<void(const LogEvent&)>> handlers_;
  std::optional<Eigen::Vector3d> began_at_;       // m, of base_link in map
  std::map<TileKey, std::int64_t> newest_shown_;  // us, the newest measurement that a tile showed
  std::optional<std::int32_t> epoch_;             // of the newest tile
  std::int64_t epoch_began_ = 0;                  // us, when its first tile was logged; 0: it is the first epoch
};

/// Start-up times of the stages, from the first packet.
void add_start(const Recording& recording, RunFigures& figures) {
  const auto lidar = recording.first.find("LIDAR_POINTS");
  if (lidar == recording.first.end()) return;
  const auto after_s = [&](std::int64_t log_utime) { return 1e-6 * static_cast<double>(log_utime - lidar->second); };
  for (const char* channel : {"MAP_POSE", "MAP_POINTS", "VOTED_POINTS", "SEMANTIC_TILE"}) {
    if (const auto it = recording.first.find(channel); it != recording.first.end())
      figures.first_after_s[channel] = after_s(it->second);
  }
  if (recording.set_off) figures.set_off_after_s = after_s(*recording.set_off);
}

}  // namespace

RunFigures read_run_log(const std::string& file) {
  output::WatchedLog reader(file, "evaluate");
  Recording recording;
  while (const auto event = reader.next()) recording.take(*event);

  RunFigures figures;
  figures.log_is_damaged = reader.damaged();
  figures.processes = static_cast<int>(recording.processes.size());
  for (const auto& [id, span] : recording.processes) {
    const std::string& service = id.first;
    const auto uptime = static_cast<double>(span.last.uptime - span.first.uptime);
    figures.memory_mb[service] = 1e-6 * static_cast<double>(span.last.memory);
    if (span.own_kb > 0) figures.own_memory_mb[service] = 1e-3 * static_cast<double>(span.own_kb);
    if (span.minute_own_kb)
      figures.own_memory_after_a_minute_mb[service] = 1e-3 * static_cast<double>(*span.minute_own_kb);
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
      const bool on_the_bus = name.starts_with("dropped.") || !is_driver(service);
      (on_the_bus ? figures.lost_messages : figures.lost_packets) += value;
    }
  }
  for (const auto& [channel, seen] : recording.gaps) {
    std::int64_t missing = seen.missing();
    // The IMU numbers its own packets: those missing at its driver too were lost on the wire.
    if (channel == "IMU") missing -= figures.losses["imu lost.packets"];
    if (missing > 0) figures.lost_by_recorder[channel] = missing;
  }
  std::erase_if(figures.losses, [](const auto& entry) { return entry.second == 0; });
  figures.latency = latency_of(recording.tiles, recording.lidar_end);
  for (const auto& [channel, messages] : recording.stages) {
    if (const auto latency = latency_of(messages, recording.lidar_end)) figures.stages[channel] = *latency;
  }
  if (figures.latency) add_start(recording, figures);
  return figures;
}

}  // namespace curbstone::evaluate
