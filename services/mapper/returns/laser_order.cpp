#include "services/mapper/returns/laser_order.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace curbstone::mapper::returns {
namespace {

constexpr int kOrderReturns = 100;      // directions with returns that a laser needs
constexpr int kTelling = 60;            // directions in which two lasers must differ,
constexpr float kDiffer = 1.06F;        // by this factor
constexpr double kMostOfThem = 0.7;     // of these: the lower one sees farther
constexpr std::size_t kNeighbours = 8;  // lasers that one is compared with, to either side
constexpr std::size_t kNamedOrder = 16;

/// Rings of the beams below the horizon, from the lowest.
std::vector<std::size_t> beams_below(const std::vector<LaserDistances>& lasers, float up) {
  std::vector<std::size_t> rings;
  for (std::size_t ring = 0; ring < lasers.size(); ++ring) {
    if (lasers[ring].returns >= kOrderReturns && up * lasers[ring].rise < 0) rings.push_back(ring);
  }
  std::sort(rings.begin(), rings.end(),
            [&](std::size_t a, std::size_t b) { return up * lasers[a].rise < up * lasers[b].rise; });
  return rings;
}

enum class Order { kUnknown, kRight, kWrong };

Order order_of(const LaserDistances& low, const LaserDistances& high) {
  int telling = 0, wrong = 0;
  for (std::size_t i = 0; i < kNumDirections; ++i) {
    const float below = low.level[i], above = high.level[i];
    if (below == 0 || above == 0) continue;
    if (below > kDiffer * above) {
      ++telling;
      ++wrong;
    } else if (above > kDiffer * below) {
      ++telling;
    }
  }
  if (telling < kTelling) return Order::kUnknown;
  return wrong > kMostOfThem * telling ? Order::kWrong : Order::kRight;
}

/// The lasers without which none contradict each other: those that contradict most others first. Of two that contradict
/// each other and equally many, both. Nothing if no two are in order.
std::vector<std::size_t> outsiders(const std::vector<LaserDistances>& lasers, const std::vector<std::size_t>& rings) {
  std::vector<std::vector<std::size_t>> against(rings.size());
  bool any_right = false;
  for (std::size_t i = 0; i < rings.size(); ++i) {
    for (std::size_t j = i + 1; j < std::min(rings.size(), i + kNeighbours + 1); ++j) {
      const Order order = order_of(lasers[rings[i]], lasers[rings[j]]);
      any_right = any_right || order == Order::kRight;
      if (order != Order::kWrong) continue;
      against[i].push_back(j);
      against[j].push_back(i);
    }
  }
  std::vector<std::size_t> found;
  while (any_right) {
    const auto worst = std::max_element(against.begin(), against.end(),
                                        [](const auto& a, const auto& b) { return a.size() < b.size(); });
    const std::size_t most = worst->size();
    if (most == 0) break;
    std::vector<std::size_t> out = {static_cast<std::size_t>(worst - against.begin())};
    const auto equal =
        std::find_if(worst->begin(), worst->end(), [&](std::size_t i) { return against[i].size() == most; });
    if (equal != worst->end()) out.push_back(*equal);
    for (const std::size_t outsider : out) {
      found.push_back(rings[outsider]);
      for (const std::size_t other : against[outsider]) std::erase(against[other], outsider);
      against[outsider].clear();
    }
  }
  return found;
}

}  // namespace

void LaserOrder::check(const std::vector<LaserDistances>& lasers) {
  const std::vector<std::size_t> rings = beams_below(lasers, up_);
  if (rings.size() < 3) return;
  num_judged_ = rings.size();
  const std::vector<std::size_t> found = outsiders(lasers, rings);
  for (const std::size_t ring : rings) {
    Laser& laser = lasers_[ring];
    const bool is_found = std::find(found.begin(), found.end(), ring) != found.end();
    laser.looks = is_found != laser.wrong ? laser.looks + 1 : 0;
    if (laser.looks < kLooks) continue;
    laser = {0, is_found};
    if (is_found) counters_.add("faults.laser_order");
  }
}

std::vector<int> LaserOrder::wrong() const {
  std::vector<int> rings;
  for (std::size_t ring = 0; ring < kMaxLasers; ++ring) {
    if (lasers_[ring].wrong) rings.push_back(static_cast<int>(ring));
  }
  return rings;
}

void LaserOrder::withhold(scan::Scan& scan) {
  if (!are_few()) return;
  const auto removed = std::erase_if(scan.points, [this](const scan::LidarPoint& point) {
    return point.ring < kMaxLasers && lasers_[point.ring].wrong;
  });
  counters_.add("withheld.laser_order", static_cast<std::int64_t>(removed));
}

void LaserOrder::add_faults(std::vector<std::string>& faults) const {
  std::vector<int> rings = wrong();
  if (rings.empty()) return;
  const std::size_t all = rings.size();
  rings.resize(std::min(all, kNamedOrder));
  faults.push_back(
      fmt::format("LiDAR: {} of its lasers ({}{}; 0: the lowest) are taken for others, for lower ones see farther than "
                  "higher ones; "
                  "{}: are lidar.model or lidar.angles_file another device's?",
                  all, fmt::join(rings, ", "), all > kNamedOrder ? ", ..." : "",
                  are_few() ? "they are not used" : "the map is wrong"));
}

}  // namespace curbstone::mapper::returns
