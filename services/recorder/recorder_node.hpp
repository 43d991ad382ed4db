#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/bus/node.hpp"
#include "services/recorder/config_cache.hpp"
#include "services/recorder/free_space.hpp"
#include "services/recorder/recorder_config.hpp"
#include "services/recorder/recording.hpp"
#include "services/recorder/session.hpp"

namespace curbstone::recorder {

/// Writes everything on the bus to an LCM log, as lcm-logger does. lcm-logger keeps LCM's queue of 30 messages, and
/// loses what arrives while it is not scheduled for 30 ms. RecorderNode uses the bus's receiver thread and a longer
/// queue, and counts its losses. A full disk is a fault in SERVICE_STATUS; recording continues in a new file when there
/// is room again. Each file begins with the CONFIG of every process that has been heard.
class RecorderNode final : public Node {
 public:
  /// `now`: us, determines the session's name. Throws std::runtime_error when the file cannot be written, unless the
  /// disk is full, failing or mounted read-only: that is a fault, and tried again each second.
  RecorderNode(const RecorderConfig& config, Tappable& bus, std::int64_t now);

  void connect(Subscriber&) override {}
  /// Passes the written data to the kernel, once a second. `now`: us.
  void tick(std::int64_t now) override;
  void finish() override;
  [[nodiscard]] NodeReport report() const override;

 private:
  void write(const std::string& channel, const void* data, int size, std::int64_t utime);
  void flush();
  void stop(const std::string& why);
  void begin(std::int64_t now);
  [[nodiscard]] bool has_room();

  RecorderConfig config_;
  std::optional<Session> session_;  // none: config_.file, or no disk yet
  FreeSpace space_;
  ConfigCache configs_;
  std::optional<Recording> recording_;  // none while the disk is full
  std::int64_t waiting_ = 0;            // messages not yet known to be on file
  std::int64_t last_ = 0;               // us, last flush or attempt
  std::int64_t deleted_ = 0;            // us, when the file that was written was found deleted; 0: never
  std::string why_deleted_;
  NodeReport report_;
};

}  // namespace curbstone::recorder
