#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/lidar/packet/refusal.hpp"

namespace curbstone::lidar::packet {

/// Says in words what is wrong with the packet stream at present. It is judged once a tick, on the host's clock (us).
/// It is status only: no product depends on it.
class LidarHealth {
 public:
  LidarHealth(int msop_port, int difop_port) : msop_port_(msop_port), difop_port_(difop_port) {}

  void point_packet_used() { ++used_; }
  void info_packet_used() { ++info_; }
  void packet_refused(Refusal why) {
    ++refused_;
    last_refusal_ = why;
  }
  void tick(std::int64_t now);
  [[nodiscard]] std::vector<std::string> faults() const;

 private:
  /// A count and when it last grew.
  struct Watched {
    std::int64_t seen = 0;
    std::int64_t grew_at = 0;
    void look(std::int64_t count, std::int64_t now);
  };
  [[nodiscard]] double since(std::int64_t time) const { return static_cast<double>(now_ - time) * 1e-6; }

  int msop_port_;
  int difop_port_;
  std::int64_t used_ = 0;
  std::int64_t info_ = 0;
  std::int64_t refused_ = 0;
  Refusal last_refusal_ = Refusal::kNone;
  std::int64_t now_ = 0;
  bool started_ = false;
  Watched used_watch_;
  Watched info_watch_;
  Watched refused_watch_;
};

}  // namespace curbstone::lidar::packet
