#include "tools/bench/curbs/scenes/degraded_scan.hpp"

#include <cmath>
#include <numbers>

#include "tools/simulate/numerics/random.hpp"

namespace curbstone::bench::curbs::scenes {
namespace {

/// 0..2 pi, counter-clockwise from ahead.
double azimuth_of(const simulate::recorded::ScanPoint& point) {
  const double azimuth = std::atan2(double{point.position.y()}, double{point.position.x()});
  return azimuth < 0 ? azimuth + 2 * std::numbers::pi : azimuth;
}

}  // namespace

std::vector<simulate::recorded::ScanPoint> worsened(const std::vector<simulate::recorded::ScanPoint>& scan,
                                                    const ScanLoss& loss, std::uint64_t seed) {
  simulate::numerics::Random random(seed);
  std::vector<simulate::recorded::ScanPoint> left;
  int laser = 0;
  double last_azimuth = 0;
  for (const simulate::recorded::ScanPoint& point : scan) {
    const double azimuth = azimuth_of(point);
    if (azimuth < last_azimuth - std::numbers::pi) ++laser;
    last_azimuth = azimuth;
    const bool kept = random.chance(loss.kept);
    const double noise = random.normal(loss.range_noise);
    if (!kept || laser % loss.lasers != 0) continue;
    left.push_back(point);
    const double range = point.position.cast<double>().norm();
    left.back().position *= static_cast<float>((range + noise) / range);
  }
  return left;
}

}  // namespace curbstone::bench::curbs::scenes
