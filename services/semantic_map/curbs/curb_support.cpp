#include "services/semantic_map/curbs/curb_support.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace curbstone::semantic_map::curbs {

namespace {

constexpr double kReach = kLineReach;
constexpr double kPlaceBin = kCellSize;  // m along: of the candidates of one place the best counts
constexpr std::size_t kBins = 34;        // of them
constexpr double kBeside = 0.06;         // m a foot may be across the line, at most
constexpr double kDirection = 0.20;      // rad a candidate's direction may be off
constexpr double kTurn = 0.20;           // rad the angle between two of them may be off
constexpr double kMinAlike = 0.5;        // cosine
static_assert(kBins * kPlaceBin > 2 * kReach);
// m: beyond this no place can be on an arc, neither along nor across; rounded up.
constexpr double kFarthest = 2.06;
static_assert(kFarthest * kFarthest >
              kReach * kReach + (kBeside + kDirection * kReach) * (kBeside + kDirection * kReach));

/// How well `b` lies on an arc along `a`, 0..1, and how far along.
struct OnArc {
  double weight = 0;
  double along = 0;  ///< m
};

OnArc on_arc(const PlacedCandidate& a, const PlacedCandidate& b) {
  const Eigen::Vector2d& up = a.up;
  const Eigen::Vector2d d = b.at - a.at;
  const double along = d.y() * up.x() - d.x() * up.y();
  const double across = d.dot(up);
  const double most_across = kBeside + kDirection * std::abs(along);
  // What follows from the places alone comes first: most are not on the line.
  if (std::abs(along) >= kReach || std::abs(across) >= most_across || up.dot(b.up) < kMinAlike) return {};
  const Eigen::Vector2d& other_up = b.up;
  const double beside = across / most_across;
  // On a circle the direction turns by twice the angle at which the other place is seen: up is to the right of along.
  const double seen_at = std::abs(along) > kPlaceBin ? across / along : 0.0;
  const double turned = up.x() * other_up.y() - up.y() * other_up.x();
  const double off = (turned + 2 * seen_at) / kTurn;
  if (std::abs(off) >= 1) return {};
  const double agreement = (1 - beside * beside) * (1 - off * off);
  const double nearness = 1 - (along / kReach) * (along / kReach);
  return {nearness * agreement * agreement, along};
}

}  // namespace

double pool_along_line(const PlacedCandidate& candidate, std::span<const PlacedCandidate> others) {
  std::array<double, kBins> best{};
  for (const PlacedCandidate& other : others) {
    if (std::abs(other.at.y() - candidate.at.y()) > kFarthest) continue;
    const OnArc arc = on_arc(candidate, other);
    if (arc.weight <= 0) continue;
    double& bin = best[static_cast<std::size_t>((arc.along + kReach) / kPlaceBin)];
    bin = std::max(bin, arc.weight * other.candidate->score);
  }
  return std::sqrt(std::inner_product(best.begin(), best.end(), best.begin(), 0.0));
}

double lean_along_line(const PlacedCandidate& candidate, std::span<const PlacedCandidate> others) {
  FaceLean lean;
  for (const PlacedCandidate& other : others) lean.add(other.candidate->lean, on_arc(candidate, other).weight);
  return lean.slope();
}

}  // namespace curbstone::semantic_map::curbs
