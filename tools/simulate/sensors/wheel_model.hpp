#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/config/config.hpp"
#include "common/config/vehicle.hpp"
#include "tools/simulate/motion/motion.hpp"
#include "tools/simulate/numerics/random.hpp"

namespace curbstone::simulate::sensors {

struct WheelNoise {
  int counts_per_revolution = 4096;  // from the drive's 1024 lines
  double radius_error = 0.003;       ///< 1 sigma, at most 0.5 %: each tyre's deviation from the configured radius
  double slips_per_minute = 3;       ///< short events while accelerating or braking
  double slip = 0.12;                ///< share by which a slipping wheel turns too fast or too slowly

  void visit(ConfigVisitor& v) {
    v.field("counts_per_revolution", counts_per_revolution, {16, 1 << 20}, "encoder counts a turn of the wheel");
    v.field("radius_error", radius_error, {0.0, 0.05}, "share, 1 sigma, cut at 0.5 %: each wheel's own radius");
    v.field("slips_per_minute", slips_per_minute, {0.0, 60.0}, "slip events while the speed changes");
    v.field("slip", slip, {0.0, 1.0}, "share by which a slipping wheel turns too fast or too slow");
  }
};

/// Two wheels that roll (mostly) with the motion, and their encoders: counts since the start, forward positive.
class WheelModel {
 public:
  WheelModel(const WheelNoise& noise, const VehicleConfig& vehicle, const motion::Motion& motion, double seconds,
             numerics::Random random);

  /// Counts of the left and the right wheel at `t`; times must not decrease.
  [[nodiscard]] std::array<std::int64_t, 2> counts(double t);
  /// rad/s at the last call, left and right.
  [[nodiscard]] std::array<double, 2> speeds() const { return speed_; }

 private:
  struct Slip {
    double from, to;
    int wheel;  // 0 left, 1 right, 2 both
    double share;
  };
  [[nodiscard]] double slip_at(double t, int wheel) const;
  void roll_to(double t);

  WheelNoise noise_;
  const motion::Motion& motion_;
  double half_track_;
  std::array<double, 2> radius_;
  std::array<double, 2> angle_{};
  std::array<double, 2> speed_{};
  std::vector<Slip> slips_;
  double t_ = 0;
};

}  // namespace curbstone::simulate::sensors
