#include "tools/bench/voting/inputs/mapped_drive.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "common/bus/local_bus.hpp"
#include "common/log/log_reader.hpp"
#include "common/log/message_order.hpp"
#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/ekf_node.hpp"
#include "services/mapper/config/mapper_config.hpp"
#include "services/mapper/mapper_node.hpp"
#include "tools/bench/voting/inputs/town_log.hpp"
#include "tools/output/ordered_log.hpp"
#include "tools/output/watched_log.hpp"

namespace curbstone::bench::voting::inputs {

namespace {

constexpr std::int64_t kTick = 20'000;  // us

/// A temporary log that is removed with this object.
class TemporaryLog {
 public:
  TemporaryLog() : path_(std::filesystem::temp_directory_path() / fmt::format("bench_voting_{}.lcmlog", getpid())) {}
  ~TemporaryLog() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryLog(const TemporaryLog&) = delete;
  TemporaryLog& operator=(const TemporaryLog&) = delete;
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

/// Filter and mapper on their own bus.
class MappingVehicle {
 public:
  explicit MappingVehicle(const DriveListener& listener) : listener_(listener), ekf_({}, bus_), mapper_({}, bus_) {
    bus_.tap([this](const std::string& channel, const void* data, int size, std::int64_t) {
      if (channel == "MAP_POINTS" || channel == "MAP_POSE" || channel == "TILE_INDEX") {
        listener_.message(channel, data, size);
      }
    });
    ekf_.connect(bus_);
    mapper_.connect(bus_);
  }

  void on_message(const LogEvent& event) {
    const std::int64_t now = message_time(event);
    if (now - ticked_ > 50 * kTick) ticked_ = now - kTick;  // at the beginning, or after a gap
    while (ticked_ + kTick <= now) tick(ticked_ += kTick);
    bus_.inject(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
    bus_.dispatch();
  }

 private:
  void tick(std::int64_t now) {
    ekf_.tick(now);
    mapper_.tick(now);
    bus_.dispatch();
    listener_.tick(now);
  }

  const DriveListener& listener_;
  LocalBus bus_;
  ekf::EkfNode ekf_;
  mapper::MapperNode mapper_;
  std::int64_t ticked_ = 0;
};

}  // namespace

void drive_and_map(const DriveSource& source, const DriveListener& listener) {
  const TemporaryLog recorded;
  if (source.log.empty()) record_town_log(source.seed, source.seconds, recorded.path());
  output::WatchedLog reader(source.log.empty() ? recorded.path() : source.log, "bench voting");
  MappingVehicle vehicle(listener);
  output::read_in_order(reader, output::is_of_a_driver, [&](const LogEvent& event) { vehicle.on_message(event); });
}

}  // namespace curbstone::bench::voting::inputs
