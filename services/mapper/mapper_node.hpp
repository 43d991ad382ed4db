#pragma once

#include <curbstone/lidar_points_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <deque>

#include "common/latency.hpp"
#include "common/node.hpp"
#include "services/mapper/map_saver.hpp"
#include "services/mapper/map_sender.hpp"
#include "services/mapper/mapper.hpp"
#include "services/mapper/mapper_config.hpp"
#include "services/mapper/odometry_history.hpp"
#include "services/mapper/revolution_assembler.hpp"

namespace curbstone {

/// LIDAR_POINTS and ODOMETRY in, MAP_POSE, MAP_POINTS and MAP_TRAJECTORY out.
///
/// A revolution is processed once odometry has passed its end, or when lidar time says that odometry is missing: so the
/// map does not depend on how the two channels interleave. Points go out at a bounded pace, at once after their
/// revolution and from tick(); what the map holds does not depend on it.
class MapperNode final : public Node {
 public:
  /// Throws MapFolderError if the map that it should go on with cannot be used.
  MapperNode(const MapperConfig& config, Publisher& bus);

  void connect(Subscriber& bus) override;
  void tick(std::int64_t now) override;
  void caught_up(std::int64_t now) override;
  void finish() override;
  [[nodiscard]] NodeReport report() const override;

  void on(const lidar_points_t& message);
  void on(const odometry_t& message);
  void on(const tile_request_t& message);

  [[nodiscard]] const Mapper& mapper() const { return mapper_; }

 private:
  void queue(std::optional<Revolution> revolution);
  void process_due(bool last_call);
  [[nodiscard]] bool due(const Revolution& revolution) const;
  void process(const Revolution& revolution);
  /// A new epoch: the map begins, or has been rearranged as a whole and goes out anew.
  void begin_epoch(const MapperUpdate& update);
  void publish_pose(const MapperUpdate& update);
  void take_changes();
  void send_changes();
  void send_index(std::int64_t now);
  void keep_map();
  void keep_map_at_the_end();

  MapperConfig config_;
  Publisher& bus_;
  MapSender sender_;
  RevolutionAssembler assembler_;
  OdometryHistory odometry_;
  Mapper mapper_;
  std::deque<Revolution> pending_;
  std::int64_t lidar_time_ = 0;    // us, newest LIDAR_POINTS
  std::int64_t first_lidar_ = 0;   // us, start of the first revolution
  std::int64_t last_end_ = 0;      // us, of the last revolution processed
  std::int32_t epoch_ = 0;         // 0: no map yet
  std::int32_t epoch_before_ = 0;  // of the map on disk
  std::optional<MapSaver> saver_;
  std::int64_t kept_ = 0;  // us, message time
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();

  bool has_news_ = false;  // a revolution whose tiles have not gone out
  bool is_pause_ = false;  // a tick has passed since it was processed
  std::int64_t index_sent_ = 0;
  int without_odometry_ = 0;  // revolutions in a row
  LatencyWindow latency_;
  Counters counters_;
};

}  // namespace curbstone
