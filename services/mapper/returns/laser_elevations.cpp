#include "services/mapper/returns/laser_elevations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "common/statistics/quantile.hpp"

namespace curbstone::mapper::returns {
namespace {

constexpr int kDirections = 180;
constexpr int kAllAround = 60;      // directions in which three lasers see the ground and agree, for a vehicle that
constexpr int kInPart = 30;         // stands, and for one that moves
constexpr double kAgree = 0.002;    // rad, with the median
constexpr float kMinRange = 1.0F;   // m: closer returns are of the vehicle itself
constexpr float kMaxRange = 25.0F;  // m
constexpr float kMaxSlope = 0.15F;  // of possible ground,
constexpr float kMaxStep = 0.3F;    // with an error of the middle laser included
constexpr float kMinStep = 0.03F;   // share of the distance: an upright surface is equally far for all three
constexpr std::size_t kMinTriples = 3;
constexpr double kUnexplained = 0.0006;  // rad: least lead in rest of the best explanation over the next
constexpr double kAlike = 0.0015;        // rad, between looks

/// The return of one laser in one direction.
struct Return {
  float distance = 0;  // m, level; 0: none
  float height = 0;    // m
};

/// Three lasers above each other: the error of the middle one's elevation against the lower and the upper one.
struct Triple {
  std::size_t ring = 0;  // the middle one
  double lower = 0;      // weights
  double upper = 0;
  double off = 0;  // rad, the median over the directions
};

/// 0 <= direction < kDirections, without an arc tangent: not all equally wide.
int direction_of(float x, float y) {
  const float along = y / (std::abs(x) + std::abs(y));      // -1..1
  const float turn = x >= 0 ? 1.0F + along : 3.0F - along;  // 0..4
  return std::min(static_cast<int>(turn * (kDirections / 4.0F)), kDirections - 1);
}

std::vector<Return> nearest_ground(const scan::Scan& scan) {
  std::vector<Return> returns(LaserElevations::kLasers * kDirections);
  for (const scan::LidarPoint& point : scan.points) {
    const Eigen::Vector3f& p = point.position;
    if (!(p.z() < 0) || point.ring >= LaserElevations::kLasers) continue;
    const float distance = p.head<2>().norm();
    if (!(distance >= kMinRange && distance <= kMaxRange)) continue;
    Return& first =
        returns[point.ring * std::size_t{kDirections} + static_cast<std::size_t>(direction_of(p.x(), p.y()))];
    if (first.distance == 0) first = {distance, p.z()};
  }
  return returns;
}

bool is_step(const Return& near, const Return& far) {
  const float away = far.distance - near.distance;
  return away > kMinStep * far.distance && std::abs(far.height - near.height) < kMaxStep * away;
}

std::optional<Triple> triple_at(const std::vector<Return>& returns, std::size_t ring, int least,
                                std::vector<double>& offs) {
  Triple triple{ring};
  offs.clear();
  for (std::size_t i = 0; i < kDirections; ++i) {
    const Return& low = returns[(ring - 1) * kDirections + i];
    const Return& mid = returns[ring * kDirections + i];
    const Return& high = returns[(ring + 1) * kDirections + i];
    if (low.distance == 0 || mid.distance == 0 || high.distance == 0) continue;
    const float slope = (high.height - low.height) / (high.distance - low.distance);
    if (std::abs(slope) > kMaxSlope || !is_step(low, mid) || !is_step(mid, high)) continue;
    const float share = (mid.distance - low.distance) / (high.distance - low.distance);
    triple.lower += static_cast<double>((1 - share) * low.distance / mid.distance);
    triple.upper += static_cast<double>(share * high.distance / mid.distance);
    offs.push_back(
        static_cast<double>((mid.height - low.height - slope * (mid.distance - low.distance)) / mid.distance));
  }
  if (offs.empty()) return std::nullopt;
  triple.lower /= static_cast<double>(offs.size());
  triple.upper /= static_cast<double>(offs.size());
  triple.off = quantile_in_place(offs, 0.5);
  const auto agree =
      std::count_if(offs.begin(), offs.end(), [&](double off) { return std::abs(off - triple.off) <= kAgree; });
  if (agree < least || 2 * agree < static_cast<std::ptrdiff_t>(offs.size())) return std::nullopt;
  return triple;
}

/// The share of a laser's error that appears in a triple.
double weight(const Triple& triple, std::size_t ring) {
  if (ring == triple.ring) return 1;
  if (ring + 1 == triple.ring) return -triple.lower;
  return ring == triple.ring + 1 ? -triple.upper : 0;
}

struct Explanation {
  std::size_t ring = 0;
  double error = 0;  // rad
  double rest = 0;   // rad: unexplained rest, root of the sum of squares
};

Explanation explain(const std::vector<Triple>& triples, std::size_t ring) {
  double all = 0, along = 0, weights = 0;
  for (const Triple& triple : triples) {
    const double w = weight(triple, ring);
    all += triple.off * triple.off;
    along += w * triple.off;
    weights += w * w;
  }
  if (weights < 0.04) return {ring, 0, std::sqrt(all)};
  return {ring, along / weights, std::sqrt(std::max(all - along * along / weights, 0.0))};
}

/// The laser that explains most, if no other explains nearly as much.
std::optional<Explanation> likeliest(const std::vector<Triple>& triples) {
  Explanation best{0, 0, 1e9}, second = best;
  for (std::size_t ring = triples.front().ring - 1; ring <= triples.back().ring + 1; ++ring) {
    const Explanation next = explain(triples, ring);
    if (next.rest < best.rest) {
      second = std::exchange(best, next);
    } else if (next.rest < second.rest) {
      second = next;
    }
  }
  if (second.rest < best.rest + kUnexplained) return std::nullopt;
  return best;
}

}  // namespace

void LaserElevations::check(const scan::Scan& scan, bool moved) {
  const std::vector<Return> returns = nearest_ground(scan);
  std::vector<Triple> triples;
  std::vector<double> offs;
  for (std::size_t ring = 1; ring + 1 < kLasers; ++ring) {
    if (auto triple = triple_at(returns, ring, moved ? kInPart : kAllAround, offs)) triples.push_back(*triple);
  }
  if (triples.size() < kMinTriples) return;
  const auto found = likeliest(triples);
  const double error = found && std::abs(found->error) > kRight ? found->error : 0;
  // A rest that one laser does not explain means uneven ground, or another device's angles.
  for (const Triple& triple : triples) {
    if (std::abs(triple.off - (error != 0 ? weight(triple, found->ring) * error : 0)) > kRight) return;
  }
  for (std::size_t ring = triples.front().ring - 1; ring <= triples.back().ring + 1; ++ring)
    judge(ring, found && ring == found->ring ? error : 0);
}

void LaserElevations::judge(std::size_t ring, double error) {
  Laser& laser = lasers_[ring];
  if (std::abs(error) <= kRight) {
    laser.looks = 0;
    if (!laser.wrong || ++laser.right < kLooks) return;
    laser = {};
    --num_wrong_;
    return;
  }
  laser.right = 0;
  if (laser.wrong) return;
  const bool goes_on = laser.looks > 0 && std::abs(error - laser.error) < kAlike;
  if (!goes_on) laser = {};
  laser.looks = std::min(laser.looks + 1, kLooks);
  laser.error += (error - laser.error) / laser.looks;
  if (laser.looks < kLooks || std::abs(laser.error) < kWrong) return;
  laser.wrong = true;
  ++num_wrong_;
  counters_.add("faults.laser");
}

void LaserElevations::withhold(scan::Scan& scan) {
  const auto removed =
      std::erase_if(scan.points, [this](const scan::LidarPoint& point) { return is_wrong(point.ring); });
  counters_.add("withheld.laser", static_cast<std::int64_t>(removed));
}

void LaserElevations::add_faults(std::vector<std::string>& faults) const {
  for (std::size_t ring = 0; ring < kLasers && any_wrong(); ++ring) {
    if (!is_wrong(ring)) continue;
    const double degrees = error(ring) * 180 / std::numbers::pi;
    faults.push_back(fmt::format(
        "LiDAR: laser {} (0: the lowest) looks {:.2f} deg {} than its angle says and is not used: are model, device "
        "information or lidar.angles_file another device's? Else have it adjusted",
        ring, std::abs(degrees), degrees > 0 ? "lower" : "higher"));
  }
}

}  // namespace curbstone::mapper::returns
