#pragma once

#include <string>

#include "common/bus/node.hpp"
#include "services/viewer/foxglove/door.hpp"
#include "services/viewer/show.hpp"

namespace curbstone::viewer {

/// The door for Foxglove, beside the page: the same world, by the protocol of Foxglove's programs. What costs the bus
/// something (LIDAR_POINTS, MAP_POINTS) is taken once a client asks for it.
class FoxgloveNode final : public Node {
 public:
  /// All must outlive this. `session`: another one for each run of the process.
  FoxgloveNode(const ViewerConfig& config, ViewerNode& node, web::Audience& clients, const std::string& session)
      : node_(node), vehicle_(config.vehicle), show_(node, vehicle_), door_(clients, session) {}

  void connect(Subscriber& bus) override;
  void tick(std::int64_t now) override;
  [[nodiscard]] NodeReport report() const override;

 private:
  ViewerNode& node_;
  VehicleConfig vehicle_;
  Show show_;
  foxglove::Door door_;
  Subscriber* subscriber_ = nullptr;
  bool points_wanted_ = false;      // by a client, now
  bool points_subscribed_ = false;  // a bus knows no end of it
};

}  // namespace curbstone::viewer
