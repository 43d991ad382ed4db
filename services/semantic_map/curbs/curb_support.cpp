#include "services/semantic_map/curbs/curb_support.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "services/semantic_map/tile/vectorised.hpp"

namespace curbstone::semantic_map::curbs {

namespace {

constexpr double kReach = kLineReach;
constexpr double kPlaceBin = kCellSize;  // m along: of the candidates in one bin the best counts
constexpr std::size_t kBins = 34;
constexpr double kBeside = 0.06;     // m by which a foot may be off the line, at most
constexpr double kDirection = 0.20;  // rad by which the direction of a candidate may be off
constexpr double kTurn = 0.20;       // rad by which the angle between two candidates may be off
constexpr double kMinAlike = 0.5;    // cosine
static_assert(kBins * kPlaceBin > 2 * kReach);

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

/// Candidates by columns.
struct Columns {
  const double *x, *y, *up_x, *up_y;
};

/// 1 for each of `n` candidates that on_arc() may give a weight, by its first conditions, else 0. Vectorised.
CURBSTONE_VECTORISED
void find_along(const Columns& others, std::size_t n, double at_x, double at_y, double up_x, double up_y,
                double* __restrict found) {
  for (std::size_t i = 0; i < n; ++i) {
    const double dx = others.x[i] - at_x;
    const double dy = others.y[i] - at_y;
    const double along = std::abs(dy * up_x - dx * up_y);
    const double across = std::abs(dx * up_x + dy * up_y);
    const bool is_along = along < kReach && across < kBeside + kDirection * along;
    found[i] = is_along && up_x * others.up_x[i] + up_y * others.up_y[i] >= kMinAlike ? 1 : 0;
  }
}

}  // namespace

CandidateField::CandidateField(std::vector<PlacedCandidate> candidates) : by_x_(std::move(candidates)) {
  std::stable_sort(by_x_.begin(), by_x_.end(), [](const auto& a, const auto& b) { return a.at.x() < b.at.x(); });
  for (std::vector<double>* column : {&x_, &y_, &up_x_, &up_y_}) column->reserve(by_x_.size());
  for (const PlacedCandidate& c : by_x_) {
    x_.push_back(c.at.x());
    y_.push_back(c.at.y());
    up_x_.push_back(c.up.x());
    up_y_.push_back(c.up.y());
  }
}

double CandidateField::pool_along_line(const PlacedCandidate& candidate) const {
  const std::span<const PlacedCandidate> near = near_x(by_x_, candidate.at.x(), kLineReach);
  const auto first = near.data() - by_x_.data();
  thread_local std::vector<double> found;  // kept for the next call
  if (found.size() < near.size()) found.resize(near.size());
  find_along({x_.data() + first, y_.data() + first, up_x_.data() + first, up_y_.data() + first}, near.size(),
             candidate.at.x(), candidate.at.y(), candidate.up.x(), candidate.up.y(), found.data());
  std::array<double, kBins> best{};
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (found[i] == 0) continue;
    const OnArc arc = on_arc(candidate, near[i]);
    if (arc.weight <= 0) continue;
    double& bin = best[static_cast<std::size_t>((arc.along + kReach) / kPlaceBin)];
    bin = std::max(bin, arc.weight * near[i].candidate->score);
  }
  return std::sqrt(std::inner_product(best.begin(), best.end(), best.begin(), 0.0));
}

double lean_along_line(const PlacedCandidate& candidate, std::span<const PlacedCandidate> others) {
  FaceLean lean;
  for (const PlacedCandidate& other : others) lean.add(other.candidate->lean, on_arc(candidate, other).weight);
  return lean.slope();
}

}  // namespace curbstone::semantic_map::curbs
