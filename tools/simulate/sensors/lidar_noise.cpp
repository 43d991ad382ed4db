#include "tools/simulate/sensors/lidar_noise.hpp"

#include <algorithm>
#include <cmath>

#include "tools/simulate/numerics/random.hpp"

namespace curbstone::simulate::sensors {

namespace {

/// m, 1 sigma: roughness of a surface at the scale of the laser's spot.
float texture(world::Surface surface) {
  switch (surface) {
    case world::Surface::kAsphalt:
      return 0.002F;
    case world::Surface::kCurbStone:
      return 0.0015F;
    case world::Surface::kPavement:
      return 0.0015F;
    case world::Surface::kGrass:
      return 0.008F;
    case world::Surface::kFoliage:
      return 0.02F;
    case world::Surface::kTrunk:
      return 0.005F;
    default:
      return 0.001F;
  }
}

}  // namespace

devices::LidarShot LidarNoise::report(const world::Hit& hit, std::uint64_t noise) const {
  if (hit.surface == world::Surface::kNone) return {};
  const std::uint64_t dice = numerics::mix_bits(noise ^ 0x5eedULL);
  if (numerics::unit_from_bits(dice) < drop_out) return {};
  // Echo power falls with the square of distance; rough surfaces return more at a grazing angle than Lambert's law
  // predicts.
  const double distance = static_cast<double>(hit.range);
  const double shine = static_cast<double>(hit.reflectivity) * std::sqrt(static_cast<double>(hit.incidence));
  const double power = shine / 0.2 * (reach_at_20_percent / distance) * (reach_at_20_percent / distance);
  if (power < 0.7 + 0.6 * numerics::unit_from_bits(numerics::mix_bits(dice))) return {};

  // A bump of the ground shifts the range by its height over the sine of the grazing angle.
  const float bump =
      texture(hit.surface) * numerics::normal_from_bits(numerics::mix_bits(noise + 1)) / std::max(hit.incidence, 0.08F);
  float range =
      hit.range + bump + static_cast<float>(range_sigma) * numerics::normal_from_bits(numerics::mix_bits(noise + 2));
  if (numerics::unit_from_bits(numerics::mix_bits(noise + 3)) < mixed_pixels)
    range *= 0.97F + 0.02F * numerics::normal_from_bits(numerics::mix_bits(noise + 4)) / 3.5F;
  if (range < static_cast<float>(min_range)) return {};
  const double intensity =
      255.0 * std::pow(shine, 0.9) * (0.92 + 0.16 * numerics::unit_from_bits(numerics::mix_bits(noise + 5)));
  return {range, static_cast<std::uint8_t>(std::clamp(intensity, 1.0, 255.0))};
}

}  // namespace curbstone::simulate::sensors
