#include "services/mapper/place_recognition/scan_context.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

namespace curbstone::mapper::place_recognition {
namespace {

constexpr float kRing = 2.5F;             // m
constexpr float kHeightStep = 1.0F / 16;  // m of height
constexpr float kLane = 2.5F;             // m to the side from which a scan is tried, too
constexpr std::size_t kSieve = 150;       // nodes that are compared in full, for each of these positions

/// Height of the ground at the vehicle: the median of the lowest points by direction and near distance.
float ground_of(const std::vector<scan::KeyframePoint>& points) {
  constexpr int kSide = 10;  // squares of 2 m
  std::array<float, static_cast<std::size_t>(kSide * kSide)> lowest;
  lowest.fill(std::numeric_limits<float>::infinity());
  for (const scan::KeyframePoint& packed : points) {
    const Eigen::Vector3f p = scan::unpack(packed);
    const int x = static_cast<int>(std::floor(p.x() / 2)) + kSide / 2,
              y = static_cast<int>(std::floor(p.y() / 2)) + kSide / 2;
    if (x < 0 || y < 0 || x >= kSide || y >= kSide) continue;
    float& low = lowest[static_cast<std::size_t>(y * kSide + x)];
    low = std::min(low, p.z());
  }
  std::vector<float> seen;
  std::copy_if(lowest.begin(), lowest.end(), std::back_inserter(seen), [](float z) { return std::isfinite(z); });
  if (seen.empty()) return 0;
  const auto middle = seen.begin() + static_cast<std::ptrdiff_t>(seen.size() / 2);
  std::nth_element(seen.begin(), middle, seen.end());
  return *middle;
}

}  // namespace

ScanContext::Heights ScanContext::heights_of(const std::vector<scan::KeyframePoint>& points, float to_left) {
  const float ground = ground_of(points);
  Heights heights{};
  for (const scan::KeyframePoint& packed : points) {
    Eigen::Vector3f p = scan::unpack(packed);
    p.y() -= to_left;
    const int ring = static_cast<int>(p.head<2>().norm() / kRing);
    if (ring >= kRings) continue;
    const float turn = 0.5F + std::atan2(p.y(), p.x()) / (2 * std::numbers::pi_v<float>);
    const int sector = std::clamp(static_cast<int>(turn * kSectors), 0, kSectors - 1);
    const float height = std::clamp((p.z() - ground) / kHeightStep, 0.0F, 255.0F);
    std::uint8_t& highest = heights[static_cast<std::size_t>(sector * kRings + ring)];
    highest = std::max(highest, static_cast<std::uint8_t>(height));
  }
  return heights;
}

ScanContext::RingKey ScanContext::key_of(const Heights& heights) {
  RingKey key{};
  for (std::size_t i = 0; i < heights.size(); ++i) key[i % kRings] += static_cast<float>(heights[i]) / kSectors;
  return key;
}

/// One less the mean cosine between sectors (equation 6 there), at the best turn; sectors that are empty in both are
/// left out.
std::array<ScanContext::Match, 2> ScanContext::compare(const Heights& scan, const Heights& node) {
  using Sectors = Eigen::Matrix<float, kRings, kSectors>;
  const auto unit = [](const Heights& heights) {
    Sectors out = Eigen::Map<const Eigen::Matrix<std::uint8_t, kRings, kSectors>>(heights.data()).cast<float>();
    for (int i = 0; i < kSectors; ++i) {
      const float norm = out.col(i).norm();
      if (norm > 0) out.col(i) /= norm;
    }
    return out;
  };
  const Sectors a = unit(scan), b = unit(node);
  const auto shows = [](const Sectors& s) {
    return Eigen::Array<bool, 1, kSectors>(s.colwise().maxCoeff().array() > 0);
  };
  const auto in_a = shows(a), in_b = shows(b);
  const Eigen::Matrix<float, kSectors, kSectors> cosine = a.transpose() * b;
  std::array<float, kSectors> distances;
  for (int turn = 0; turn < kSectors; ++turn) {
    float sum = 0;
    int shown = 0;
    for (int i = 0; i < kSectors; ++i) {
      const int j = i + turn < kSectors ? i + turn : i + turn - kSectors;
      if (!in_a[i] && !in_b[j]) continue;
      sum += cosine(i, j);
      ++shown;
    }
    distances[static_cast<std::size_t>(turn)] = shown > 0 ? 1 - sum / static_cast<float>(shown) : 1;
  }
  std::array<Match, 2> best;
  const auto first = std::min_element(distances.begin(), distances.end());
  best[0] = {*first, static_cast<int>(first - distances.begin())};
  for (int away = kSectors / 4; away <= 3 * kSectors / 4; ++away) {
    const int turn = (best[0].turn + away) % kSectors;
    const float distance = distances[static_cast<std::size_t>(turn)];
    if (distance < best[1].distance) best[1] = {distance, turn};
  }
  return best;
}

void ScanContext::add(int node, const std::vector<scan::KeyframePoint>& points) {
  Entry entry{node, heights_of(points, 0), {}};
  entry.key = key_of(entry.heights);
  entries_.push_back(entry);
}

std::vector<PlaceCandidate> ScanContext::query(const std::vector<scan::KeyframePoint>& points, int most) const {
  struct Found {
    Match match;
    int node;
  };
  std::vector<Found> found;
  for (const float to_left : {0.0F, kLane, -kLane}) {
    const Heights heights = heights_of(points, to_left);
    for (const std::size_t i : alike(key_of(heights))) {
      for (const Match& match : compare(heights, entries_[i].heights)) {
        if (match.distance < 1) found.push_back({match, entries_[i].node});
      }
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Found& a, const Found& b) { return a.match.distance < b.match.distance; });
  std::vector<PlaceCandidate> out;
  for (const auto& [match, node] : found) {
    if (static_cast<int>(out.size()) >= most) break;
    const double yaw = std::remainder(match.turn * 2 * std::numbers::pi / kSectors, 2 * std::numbers::pi);
    const bool known = std::any_of(out.begin(), out.end(), [&, n = node](const PlaceCandidate& other) {
      return other.node == n && std::abs(std::remainder(other.yaw - yaw, 2 * std::numbers::pi)) < 1;
    });
    if (!known) out.push_back({node, yaw, static_cast<double>(match.distance)});
  }
  return out;
}

/// The entries with the nearest keys, nearest first.
std::vector<std::size_t> ScanContext::alike(const RingKey& key) const {
  std::vector<std::pair<float, std::size_t>> near;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    float off = 0;
    for (std::size_t ring = 0; ring < kRings; ++ring) {
      const float d = key[ring] - entries_[i].key[ring];
      off += d * d;
    }
    near.emplace_back(off, i);
  }
  const std::size_t some = std::min(kSieve, near.size());
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(some), near.end());
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < some; ++k) out.push_back(near[k].second);
  return out;
}

}  // namespace curbstone::mapper::place_recognition
