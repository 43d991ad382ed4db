#pragma once

#include <curbstone/map_points_t.hpp>
#include <curbstone/service_status_t.hpp>

#include "common/bus/counters.hpp"
#include "services/viewer/foxglove/feed.hpp"
#include "services/viewer/viewer_node.hpp"

namespace curbstone::viewer {

/// The state that only Foxglove shows, beside that of the node: all counters, a log, the mapper's points. Used live and
/// for the export of a log. One thread.
class FoxgloveState {
 public:
  /// Both must outlive this.
  FoxgloveState(const ViewerNode& node, const VehicleConfig& vehicle) : node_(node), vehicle_(vehicle) {}

  void on(const service_status_t& message);
  void on(const map_points_t& message);

  /// Valid until the node or this object takes the next message.
  [[nodiscard]] foxglove::World world() const;
  [[nodiscard]] const foxglove::StatusHistory& status() const { return status_; }
  /// dropped.status (more processes than StatusHistory keeps), refused.map_points.
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  const ViewerNode& node_;
  const VehicleConfig& vehicle_;
  foxglove::StatusHistory status_;
  foxglove::NearPoints points_;
  Counters counters_;
};

}  // namespace curbstone::viewer
