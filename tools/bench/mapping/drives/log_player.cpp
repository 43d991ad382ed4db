#include "tools/bench/mapping/drives/log_player.hpp"

#include <curbstone/lidar_points_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <deque>
#include <optional>
#include <utility>

#include "common/bus/local_bus.hpp"
#include "common/log/message_order.hpp"
#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/ekf_node.hpp"
#include "services/mapper/scan/scan_assembler.hpp"
#include "tools/output/watched_log.hpp"

namespace curbstone::bench::mapping::drives {
namespace {

/// Ekf and assembler on a bus; a revolution is passed on once odometry has reached its end.
class LogFeed {
 public:
  LogFeed(bool with_odometry, const MappingDrive::Take& take) : take_(take), with_odometry_(with_odometry) {
    if (with_odometry) {
      ekf_.emplace(ekf::base::EkfConfig{}, bus_);
      ekf_->connect(bus_);
    }
    bus_.subscribe<lidar_points_t>("LIDAR_POINTS", [this](const lidar_points_t& m) { queue(assembler_.add(m)); });
    bus_.subscribe<odometry_t>("ODOMETRY", [this](const odometry_t& m) {
      history_.add({m.utime, pose_from_arrays(m.position, m.orientation), (m.flags & odometry_t::INITIALISED) != 0,
                    (m.flags & odometry_t::STATIONARY) != 0});
    });
  }
  void on(const LogEvent& event) {
    bus_.inject(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
    bus_.dispatch();
    pass_on(false);
  }
  void finish() {
    queue(assembler_.flush());
    if (ekf_) ekf_->finish();
    bus_.dispatch();
    pass_on(true);
  }

 private:
  void queue(std::optional<mapper::scan::Scan> scan) {
    if (scan) pending_.push_back(std::move(*scan));
  }
  void pass_on(bool all) {
    while (!pending_.empty() && (all || !with_odometry_ || history_.reaches(pending_.front().end))) {
      const mapper::scan::Scan& next = pending_.front();
      history_.set_horizon(next.end);
      // The filter levels itself while standing; a map begun earlier would be tilted.
      const bool level = !with_odometry_ || started_ || history_.covers(next.start, next.end);
      if (level) take_(next, history_);
      started_ = started_ || level;
      history_.forget_before(next.start - 200'000);
      pending_.pop_front();
    }
  }

  const MappingDrive::Take& take_;
  bool with_odometry_;
  bool started_ = false;
  LocalBus bus_;
  std::optional<ekf::EkfNode> ekf_;
  mapper::scan::ScanAssembler assembler_;
  mapper::scan::OdometryHistory history_;
  std::deque<mapper::scan::Scan> pending_;
};

}  // namespace

void play_events(const EventSource& source, bool with_odometry, const MappingDrive::Take& take) {
  LogFeed feed(with_odometry, take);
  MessageOrder order;
  source([&](LogEvent event) {
    order.push(std::move(event));
    while (const auto next = order.pop()) feed.on(*next);
  });
  while (const auto next = order.pop_rest()) feed.on(*next);
  feed.finish();
}

void play_log(const std::string& file, bool with_odometry, const MappingDrive::Take& take) {
  output::WatchedLog reader(file, "bench mapping");
  const auto source = [&](const std::function<void(LogEvent)>& hand_over) {
    while (auto event = reader.next()) hand_over(std::move(*event));
  };
  play_events(source, with_odometry, take);
}

}  // namespace curbstone::bench::mapping::drives
