#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/time/silence_timer.hpp"
#include "drivers/lidar/decoding/refusal.hpp"
#include "drivers/lidar/models/base/model.hpp"

namespace curbstone::lidar {

/// What to do about packets that are refused for this reason, in words.
[[nodiscard]] std::string remedy(decoding::Refusal why, const models::ModelTable& model);

/// Describes the present faults of the packet stream in words. Judged once per tick, on the host's clock (us). Status
/// only: no product depends on it.
class LidarHealth {
 public:
  LidarHealth(int msop_port, int difop_port) : msop_port_(msop_port), difop_port_(difop_port) {}

  void point_packet_used() { ++used_; }
  void info_packet_used() { ++info_; }
  void packet_refused(const std::string& remedy) {
    ++refused_;
    remedy_ = remedy;
  }
  void tick(std::int64_t now);
  /// No point packet has come for a second of ticks: what is missing then was not lost on the way.
  [[nodiscard]] bool is_silent() const { return used_watch_.silence.silent() >= kSilence; }
  /// The device information is too old to say anything of the device now.
  [[nodiscard]] bool info_is_old() const { return info_watch_.silence.silent() >= kInfoSilence; }
  /// `model`: nullptr while it is unknown.
  [[nodiscard]] std::vector<std::string> faults(const models::Model* model) const;

 private:
  static constexpr std::int64_t kSilence = 1'000'000;      // us without a point packet
  static constexpr std::int64_t kInfoSilence = 5'000'000;  // us without information, sent one to ten times a second

  /// A count, and for how long it has not increased.
  struct Watched {
    std::int64_t seen = 0;
    SilenceTimer silence;
    void look(std::int64_t count, std::int64_t now);
  };

  int msop_port_;
  int difop_port_;
  std::int64_t used_ = 0;
  std::int64_t info_ = 0;
  std::int64_t refused_ = 0;
  std::string remedy_;  ///< of the latest refusal
  Watched used_watch_;
  Watched info_watch_;
  Watched refused_watch_;
};

}  // namespace curbstone::lidar
