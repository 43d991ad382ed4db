#include "services/mapper/returns/stray_returns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace curbstone::mapper::returns {
namespace {

constexpr float kBeside = 2.5e-4F;   // s between shots in nearly the same direction
constexpr std::size_t kBesides = 2;  // shots of the same laser to either side
constexpr std::size_t kMaxNeighbours =
    64;                              // returns of another laser; usually some 20, but more if all have the same time
constexpr float kSame = 0.1F;        // m between ranges of one surface,
constexpr float kSameShare = 0.06F;  // and of the range
constexpr float kApart = 3.0F;       // factor on that: least difference of ranges of two surfaces
constexpr std::size_t kMinReturns = 500;  // returns for a share to be meaningful

float alike(float range) {
  return kSame + kSameShare * range;
}

}  // namespace

void StrayReturns::Rings::sort(const std::vector<scan::LidarPoint>& points) {
  range.resize(points.size());
  for (std::vector<std::uint32_t>& ring : of) ring.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    range[i] = points[i].position.norm();
    of[points[i].ring].push_back(static_cast<std::uint32_t>(i));
  }
}

/// Neighbourhood tests; the returns are visited in order.
class StrayReturns::Neighbours {
 public:
  Neighbours(const std::vector<scan::LidarPoint>& points, const Rings& rings, std::size_t ring)
      : points_(points), rings_(rings), ring_(ring) {}

  /// Whether a return of the same laser is near the k-th.
  [[nodiscard]] bool has_beside(std::size_t k) const {
    const std::vector<std::uint32_t>& own = rings_.of[ring_];
    const std::size_t first = k - std::min(k, kBesides);
    const std::size_t last = std::min(k + kBesides, own.size() - 1);
    for (std::size_t j = first; j <= last; ++j) {
      if (j != k && is_near(own[k], own[j]) && is_alike(own[k], own[j])) return true;
    }
    return false;
  }
  /// Whether the two neighbours of the k-th agree with each other, but not with it.
  [[nodiscard]] bool is_out_of_line(std::size_t k) const {
    const std::vector<std::uint32_t>& own = rings_.of[ring_];
    if (k == 0 || k + 1 >= own.size()) return false;
    const std::uint32_t before = own[k - 1], after = own[k + 1];
    if (!is_near(before, own[k]) || !is_near(own[k], after) || !is_alike(before, after)) return false;
    const float nearer = std::min(rings_.range[own[k]], rings_.range[before]);
    return std::abs(rings_.range[own[k]] - rings_.range[before]) > kApart * alike(nearer);
  }
  /// Whether a return of the lasers above or below is near the k-th. `k` must not decrease.
  [[nodiscard]] bool has_above_or_below(std::size_t k) {
    const std::uint32_t point = rings_.of[ring_][k];
    return (ring_ > 0 && has_in(ring_ - 1, at_below_, point)) || (ring_ < 255 && has_in(ring_ + 1, at_above_, point));
  }

 private:
  [[nodiscard]] bool is_near(std::uint32_t a, std::uint32_t b) const {
    return std::abs(points_[a].time - points_[b].time) <= kBeside;
  }
  [[nodiscard]] bool is_alike(std::uint32_t a, std::uint32_t b) const {
    return std::abs(rings_.range[a] - rings_.range[b]) <= alike(std::min(rings_.range[a], rings_.range[b]));
  }
  [[nodiscard]] bool has_in(std::size_t other, std::size_t& at, std::uint32_t point) const {
    const std::vector<std::uint32_t>& its = rings_.of[other];
    while (at < its.size() && points_[its[at]].time < points_[point].time - kBeside) ++at;
    const std::size_t end = std::min(its.size(), at + kMaxNeighbours);
    for (std::size_t j = at; j < end && points_[its[j]].time <= points_[point].time + kBeside; ++j) {
      if (is_alike(point, its[j])) return true;
    }
    return false;
  }

  const std::vector<scan::LidarPoint>& points_;
  const Rings& rings_;
  std::size_t ring_;
  std::size_t at_below_ = 0, at_above_ = 0;
};

void StrayReturns::filter(scan::Scan& scan) {
  rings_.sort(scan.points);
  std::vector<bool> alone(scan.points.size());
  std::size_t returns = 0, strays = 0;
  for (std::size_t ring = 0; ring < rings_.of.size(); ++ring) {
    Neighbours beside(scan.points, rings_, ring);
    for (std::size_t k = 0; k < rings_.of[ring].size(); ++k) {
      const std::uint32_t point = rings_.of[ring][k];
      if (!(rings_.range[point] <= kReach)) continue;
      ++returns;
      if (beside.has_beside(k) || beside.has_above_or_below(k)) continue;
      alone[point] = true;
      if (beside.is_out_of_line(k)) ++strays;
    }
  }
  if (returns < kMinReturns) return;
  share_ = static_cast<double>(strays) / static_cast<double>(returns);
  judge();
  if (!filters_) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (!alone[i]) scan.points[kept++] = scan.points[i];
  }
  counters_.add("withheld.stray", static_cast<std::int64_t>(scan.points.size() - kept));
  scan.points.resize(kept);
}

void StrayReturns::judge() {
  const bool says_other = filters_ ? share_ < kFew : share_ > kMany;
  looks_ = says_other ? looks_ + 1 : 0;
  if (looks_ < kLooks) return;
  looks_ = 0;
  filters_ = !filters_;
  if (filters_) counters_.add("strays");
}

void StrayReturns::add_faults(std::vector<std::string>& faults) const {
  if (!filters_) return;
  faults.push_back(fmt::format(
      "LiDAR: {:.1f} % of its returns stand alone in the air or below the ground (rain, snow, dust, exhaust, a wet "
      "road) and are left out: go slowly, clean the window",
      100 * share_));
}

}  // namespace curbstone::mapper::returns
