#pragma once

#include <curbstone/lidar_points_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <deque>
#include <optional>

#include "common/bus/node.hpp"
#include "common/shell/latency.hpp"
#include "services/mapper/config/mapper_config.hpp"
#include "services/mapper/detection/sensor_watch.hpp"
#include "services/mapper/journal/drive_journal.hpp"
#include "services/mapper/map_sender.hpp"
#include "services/mapper/mapper.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/odometry_resend.hpp"
#include "services/mapper/scan/packet_intake.hpp"
#include "services/mapper/scan/scan_assembler.hpp"
#include "services/mapper/storage/map_saver.hpp"

namespace curbstone::mapper {

/// LIDAR_POINTS and ODOMETRY in, MAP_POSE, MAP_POINTS and MAP_TRAJECTORY out.
///
/// A scan is processed once odometry has passed its end, or when lidar time says that odometry is missing: so the
/// map does not depend on how the two channels interleave. Packets and odometry that were lost on the bus are asked for
/// and waited for, in order: so it does not depend on them either. Points go out at a bounded pace, at once after their
/// scan and from tick(); what the map holds does not depend on it.
class MapperNode final : public Node {
 public:
  /// Throws MapFolderError if the map that it should go on with cannot be used, JournalError if another process keeps
  /// the journal.
  MapperNode(const config::MapperConfig& config, Publisher& bus);

  void connect(Subscriber& bus) override;
  void tick(std::int64_t now) override;
  void caught_up(std::int64_t now) override;
  void finish() override;
  [[nodiscard]] NodeReport report() const override;

  void on(const lidar_points_t& message);
  void on(const odometry_t& message);
  /// What was sent again.
  void on_again(const lidar_points_t& message);
  void on_again(const odometry_t& message);
  void on(const tile_request_t& message);

  [[nodiscard]] const Mapper& mapper() const { return *mapper_; }

 private:
  struct Pending {
    scan::Scan scan;
    std::int64_t since;  // us, lidar time
  };
  void assemble(const lidar_points_t& packet);
  void queue(std::optional<scan::Scan> scan);
  void process_due(bool last_call);
  [[nodiscard]] bool due(const Pending& pending);
  void note_late_odometry();
  void process(scan::Scan scan);
  void watch_sensors(const MapperUpdate& update);
  /// A new epoch: the map begins, or has been rearranged as a whole and goes out anew.
  void begin_epoch(std::int64_t utime);
  [[nodiscard]] std::vector<journal::RecordedPose> drive_so_far();
  void publish_pose(const MapperUpdate& update);
  void take_changes(std::int64_t now);
  void send_changes(std::int64_t now);
  void send_index(std::int64_t now);
  void begin_new_drive();
  void keep_map();
  void keep_map_at_the_end();
  void begin_map();
  void note_loaded();
  [[nodiscard]] bool resume_drive();
  void keep_pose(const MapperUpdate& update);

  config::MapperConfig config_;
  Publisher& bus_;
  MapSender sender_;
  scan::PacketIntake packets_;
  scan::ScanAssembler assembler_;
  scan::OdometryHistory odometry_;
  scan::OdometryResend odometry_resend_;
  std::shared_ptr<SpillFile> far_;  // what is far from the vehicle
  std::optional<Mapper> mapper_;    // never none
  detection::SensorWatch watch_;
  std::deque<Pending> pending_;
  std::int64_t first_lidar_ = 0;   // us, start of the first scan
  std::int64_t first_heard_ = 0;   // us, lidar time then
  std::int64_t last_end_ = 0;      // us, of the last scan processed
  std::int32_t epoch_ = 0;         // 0: no map yet
  std::int32_t epoch_before_ = 0;  // of the map on disk
  std::optional<storage::MapSaver> saver_;
  std::optional<storage::MapVersions> loaded_;  // from its folder, until the first epoch, of which they are then
  std::int64_t kept_ = 0;                       // us, message time
  std::optional<journal::DriveJournal> journal_;
  std::string not_gone_on_;                           // why the drive before was not gone on with
  std::vector<journal::RecordedPose> resumed_drive_;  // of the mapper before, until it has gone out
  std::vector<journal::RecordedPose> start_drive_;    // of the first standstill, until it is over
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();

  bool has_unsent_ = false;  // a scan whose tiles have not gone out
  bool is_pause_ = false;    // a tick has passed since it was processed
  std::int64_t index_sent_ = 0;
  int without_odometry_ = 0;         // scans in a row
  std::deque<std::int64_t> missed_;  // us, ends of scans for which odometry had not come
  std::int64_t too_late_ = 0;        // us, the newest of those for which it came later
  LatencyWindow latency_;
  Counters counters_;  // and those of mappers before this one
};

}  // namespace curbstone::mapper
