#pragma once

#include <curbstone/lidar_points_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <optional>

#include "common/bus/node.hpp"
#include "common/shell/latency.hpp"
#include "services/mapper/config/mapper_config.hpp"
#include "services/mapper/detection/odometry_restart.hpp"
#include "services/mapper/detection/sensor_monitor.hpp"
#include "services/mapper/journal/drive_journal.hpp"
#include "services/mapper/lidar_at_start.hpp"
#include "services/mapper/map_sender.hpp"
#include "services/mapper/mapper.hpp"
#include "services/mapper/scan/scan_synchronizer.hpp"
#include "services/mapper/storage/map_saver.hpp"

namespace curbstone::mapper {

/// Node of the mapper. In: LIDAR_POINTS and ODOMETRY. Out: MAP_POSE, MAP_POINTS and MAP_TRAJECTORY.
///
/// The map does not depend on how the two channels interleave, nor on losses on the bus: see scan::ScanSynchronizer.
/// Points are published at a bounded rate, right after their scan and from tick(); the content of the map does not
/// depend on the rate.
class MapperNode final : public Node {
 public:
  /// Throws MapFolderError if the map of an earlier drive cannot be used, JournalError if another process holds the
  /// journal.
  MapperNode(const config::MapperConfig& config, Publisher& bus);

  void connect(Subscriber& bus) override;
  void tick(std::int64_t now) override;
  void caught_up(std::int64_t now) override;
  void end_drive() override;
  [[nodiscard]] std::size_t num_outstanding() const override { return sender_.num_outstanding(); }
  void finish() override;
  [[nodiscard]] NodeReport report() const override;

  void on(const lidar_points_t& message);
  void on(const odometry_t& message);
  /// Messages that were sent again on request.
  void on_resent(const lidar_points_t& message);
  void on_resent(const odometry_t& message);
  void on(const tile_request_t& message);

  [[nodiscard]] const Mapper& mapper() const { return *mapper_; }

 private:
  static constexpr std::int64_t kReportedFor = 60'000'000;  // us of the drive for which an event is reported

  void process_due();
  void process(scan::Scan scan);
  void monitor_sensors(const MapperUpdate& update);
  /// Begins an epoch: the map begins, or has been rearranged and is sent again as a whole.
  void name_epoch(std::int64_t utime);
  void begin_epoch(std::int64_t utime, bool is_rearranged);
  [[nodiscard]] std::vector<journal::RecordedPose> drive_so_far();
  void publish_pose(const MapperUpdate& update);
  void take_changes(std::int64_t now);
  void send_changes(std::int64_t now);
  void send_index(std::int64_t now);
  void send_due_index(std::int64_t now);
  void send_rest(std::int64_t now);
  [[nodiscard]] bool is_rearranging(std::int64_t now) const;
  /// `why`: the cause, for the fault that reports it.
  void begin_new_drive(const std::string& why);
  void check_lidar(const MapperUpdate& update);
  void begin_with_other_lidar(const std::string& why);
  void keep_map();
  void keep_map_at_the_end();
  void begin_map();
  void open_journal();
  [[nodiscard]] bool resume_drive();
  [[nodiscard]] std::int64_t resume_after(journal::RecordedDrive& drive) const;
  void note_missing(const scan::Scan& scan);
  void journal_epoch(const std::vector<journal::RecordedPose>& drive, bool is_rearranged);
  void add_counters(Counters& counters) const;
  void add_disk_faults(std::vector<std::string>& faults) const;
  void add_turn_faults(std::vector<std::string>& faults) const;
  void add_fit_faults(std::vector<std::string>& faults) const;
  void keep_pose(const MapperUpdate& update);

  config::MapperConfig config_;
  Publisher& bus_;

  // Input and the map.
  scan::ScanSynchronizer input_;
  std::shared_ptr<SpillFile> spill_file_;  // tiles and keyframe scans far from the vehicle
  std::optional<Mapper> mapper_;           // always has a value
  detection::SensorMonitor sensor_monitor_;
  detection::OdometryRestart odometry_restart_;
  LidarAtStart lidar_at_start_;
  std::int64_t last_end_ = 0;                           // us, of the last scan processed
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();  // m in map, after that scan
  bool is_pause_ = false;                               // a tick has passed since that scan was processed
  bool is_over_ = false;                                // the drive is

  // Publication.
  MapSender sender_;
  std::int32_t epoch_ = 0;          // 0: no map yet
  std::int32_t epoch_before_ = 0;   // of the map on disk or of the drive before, which a new epoch exceeds; 0: none
  std::int64_t rearranged_at_ = 0;  // us, end of the last scan if that rearranged the map; 0: it did not
  bool has_unsent_ = false;         // tiles of the last scan were not sent yet
  std::int64_t index_sent_ = 0;     // us; 0: not in this epoch yet
  std::vector<journal::RecordedPose> resumed_drive_;  // of the mapper that died, until it is sent
  std::vector<journal::RecordedPose> start_drive_;    // of the first standstill, until it is over

  // Disk.
  std::optional<storage::MapSaver> saver_;
  std::optional<journal::DriveJournal> journal_;
  /// Of the drive that was resumed: what nobody mapped.
  struct Missing {
    std::int64_t time = 0;   // us
    std::int64_t since = 0;  // us, end of the first scan after it
  };
  Missing missing_;
  std::int64_t resumed_from_ = 0;  // us, of its last pose that counts; 0 after the first scan
  std::string why_new_map_;        // why the previous drive was not continued

  // Report.
  LatencyWindow latency_;
  Counters counters_;  // of the node, and of mappers before this one
};

}  // namespace curbstone::mapper
