#pragma once

#include <string>

#include "common/bus/node.hpp"
#include "services/viewer/foxglove/door.hpp"
#include "services/viewer/show.hpp"

namespace curbstone::viewer {

/// The Foxglove server beside the page: the same state, in Foxglove's protocol. LIDAR_POINTS and MAP_POINTS load the
/// bus, so they are subscribed to only once a client asks for them.
class FoxgloveNode final : public Node {
 public:
  /// All arguments but `session` must outlive this. `session`: unique for each run of the process.
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
  bool points_wanted_ = false;      // by a client, at present
  bool points_subscribed_ = false;  // stays true: the bus has no unsubscribe
};

}  // namespace curbstone::viewer
