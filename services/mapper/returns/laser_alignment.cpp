#include "services/mapper/returns/laser_alignment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/statistics/quantile.hpp"

namespace curbstone::mapper::returns {
namespace {

constexpr int kMostAside = 16;          // directions that are searched to either side
constexpr int kFilled = 100;            // directions with returns that a laser needs,
constexpr std::size_t kUpright = 60;    // and with upright surfaces
constexpr float kNearest = 2.0F;        // m
constexpr float kFarthest = 40.0F;      // m
constexpr float kSameFar = 0.05F;       // m between the distances of two lasers that meet an upright surface,
constexpr float kSameFarShare = 0.01F;  // and of the distance
constexpr double kFits = 0.05;          // m: median misfit of a laser that is right,
constexpr double kRightOff = 0.06;      // and its offset
constexpr double kExplains = 0.5;       // of the misfit: what is left if the right angle was found

using Distances = std::array<float, kNumDirections>;  // as LaserDistances::level

/// Where both lasers meet an upright surface, how far it is; elsewhere 0.
Distances upright(const Distances& below, const Distances& above) {
  Distances both{};
  for (std::size_t i = 0; i < kNumDirections; ++i) {
    const float near = std::min(below[i], above[i]), far = std::max(below[i], above[i]);
    if (near >= kNearest && far <= kFarthest && far - near < kSameFar + kSameFarShare * near)
      both[i] = 0.5F * (near + far);
  }
  return both;
}

struct Fit {
  int shift = 0;        // directions that the laser is turned by
  double off = 0;       // m, median
  double misfit = 1e9;  // m, median beyond that
};

/// How the laser's distances fit the surfaces if it is turned by `shift`. Nothing if too few can be compared.
std::optional<Fit> fit(const Distances& laser, const Distances& surfaces, int shift, std::vector<double>& differences) {
  differences.clear();
  for (int i = 0; i < kNumDirections; ++i) {
    const float surface = surfaces[static_cast<std::size_t>((i + shift + kNumDirections) % kNumDirections)];
    const float distance = laser[static_cast<std::size_t>(i)];
    if (surface > 0 && distance > 0) differences.push_back(static_cast<double>(distance - surface));
  }
  if (differences.size() < kUpright) return std::nullopt;
  Fit fit{shift, quantile_in_place(differences, 0.5)};
  for (double& difference : differences) difference = std::abs(difference - fit.off);
  fit.misfit = quantile_in_place(differences, 0.5);
  return fit;
}

/// Nothing if the look does not tell.
std::optional<LaserAlignment::Error> error_of(const Distances& laser, const Distances& surfaces) {
  std::vector<double> differences;
  const std::optional<Fit> as_it_is = fit(laser, surfaces, 0, differences);
  if (!as_it_is) return std::nullopt;
  if (as_it_is->misfit < kFits) return LaserAlignment::Error{0, as_it_is->off};
  Fit best = *as_it_is;
  for (int shift = -kMostAside; shift <= kMostAside; ++shift) {
    const std::optional<Fit> turned = fit(laser, surfaces, shift, differences);
    if (turned && turned->misfit < best.misfit) best = *turned;
  }
  if (std::abs(best.shift) == kMostAside || best.misfit > kExplains * as_it_is->misfit) return std::nullopt;
  return LaserAlignment::Error{kDirectionDegrees * best.shift, best.off};
}

}  // namespace

void LaserAlignment::check(const std::vector<LaserDistances>& lasers) {
  std::vector<std::size_t> rings;  // that return
  for (std::size_t ring = 0; ring < lasers.size(); ++ring) {
    if (lasers[ring].returns >= kFilled) rings.push_back(ring);
  }
  num_lasers_ = static_cast<int>(rings.size());
  for (std::size_t i = 1; i + 1 < rings.size(); ++i) {
    const Distances surfaces = upright(lasers[rings[i - 1]].level, lasers[rings[i + 1]].level);
    if (const auto error = error_of(lasers[rings[i]].level, surfaces)) judge(rings[i], *error);
  }
}

void LaserAlignment::judge(std::size_t ring, const Error& error) {
  Laser& laser = lasers_[ring];
  if (std::abs(error.aside) < kAside && std::abs(error.off) < kOff) {
    laser.looks = 0;
    if (std::abs(error.off) > kRightOff || !laser.wrong || ++laser.right < kLooks) return;
    laser = {};
    --num_wrong_;
    return;
  }
  laser.right = 0;
  const bool goes_on = laser.looks > 0 && std::abs(error.aside - laser.error.aside) < 1.5 * kDirectionDegrees &&
                       std::abs(error.off - laser.error.off) < kOff;
  laser.error = error;
  laser.looks = goes_on ? laser.looks + 1 : 1;
  if (laser.wrong || laser.looks < kLooks) return;
  laser.wrong = true;
  ++num_wrong_;
  counters_.add("faults.laser_aligned");
}

void LaserAlignment::withhold(scan::Scan& scan) {
  if (!are_few()) return;
  const auto removed =
      std::erase_if(scan.points, [this](const scan::LidarPoint& point) { return is_wrong(point.ring); });
  counters_.add("withheld.laser_aligned", static_cast<std::int64_t>(removed));
}

void LaserAlignment::add_faults(std::vector<std::string>& faults) const {
  for (std::size_t ring = 0; ring < kMaxLasers && any_wrong(); ++ring) {
    if (!is_wrong(ring)) continue;
    const Error& error = lasers_[ring].error;
    const std::string what =
        std::abs(error.aside) >= kAside
            ? fmt::format("looks {:.1f} deg to the {} of its angle", std::abs(error.aside),
                          error.aside > 0 ? "left" : "right")
            : fmt::format("measures {:.2f} m too {}", std::abs(error.off), error.off > 0 ? "much" : "little");
    faults.push_back(
        fmt::format("LiDAR: laser {} (0: the lowest) {}, by those above and below it, and is {}: are model, device "
                    "information or lidar.angles_file another device's? Else have it adjusted",
                    ring, what, are_few() ? "not used" : "used, as too many are wrong to tell which is right"));
  }
}

}  // namespace curbstone::mapper::returns
