#include "services/mapper/returns/blind_sectors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curbstone::mapper::returns {
namespace {

constexpr int kMany = 50;  // returns of a sector: the ground alone gives more
constexpr int kFew = 15;
constexpr int kWidth = 360 / BlindSectors::kSectors;

}  // namespace

void BlindSectors::check(const scan::Scan& scan) {
  std::array<int, kSectors> returns{};
  for (const scan::LidarPoint& point : scan.points) {
    const Eigen::Vector3f& p = point.position;
    if (!(p.squaredNorm() > kNear * kNear)) continue;
    const double turn = std::atan2(static_cast<double>(p.y()), static_cast<double>(p.x())) / (2 * std::numbers::pi);
    const int sector = static_cast<int>(std::floor((turn + 1) * kSectors)) % kSectors;
    ++returns[static_cast<std::size_t>(sector)];
  }
  const auto seeing = std::count_if(returns.begin(), returns.end(), [](int n) { return n >= kMany; });
  if (3 * seeing < kSectors) return;  // part of a revolution, or an empty plain
  for (std::size_t i = 0; i < sectors_.size(); ++i) {
    Sector& sector = sectors_[i];
    if (returns[i] >= kMany) {
      sector = {.steady = std::min(sector.steady + 1, kSteady)};
    } else if (returns[i] <= kFew && sector.steady == kSteady && sector.empty < kBlind) {
      if (++sector.empty == kBlind) counters_.add("faults.blind_sector");
    } else if (returns[i] > kFew && sector.empty < kBlind) {
      sector.empty = 0;
    }
  }
}

std::vector<int> BlindSectors::blind() const {
  std::vector<int> degrees;
  for (int i = 0; i < kSectors; ++i) {
    if (sectors_[static_cast<std::size_t>(i)].empty < kBlind) continue;
    const int middle = kWidth * i + kWidth / 2;
    degrees.push_back(middle > 180 ? middle - 360 : middle);
  }
  return degrees;
}

std::vector<std::string> BlindSectors::arcs() const {
  const auto is_blind = [&](int i) {
    return sectors_[static_cast<std::size_t>((i + kSectors) % kSectors)].empty >= kBlind;
  };
  const auto degrees = [](int i) {
    const int turn = kWidth * i % 360;
    return turn > 180 ? turn - 360 : turn;
  };
  std::vector<std::string> arcs;
  for (int first = 0; first < kSectors; ++first) {
    if (!is_blind(first) || is_blind(first - 1)) continue;
    int end = first;
    while (is_blind(end)) ++end;
    arcs.push_back(fmt::format("from {} to {}", degrees(first), degrees(end)));
  }
  return arcs;
}

void BlindSectors::add_faults(std::vector<std::string>& faults) const {
  const std::vector<int> degrees = blind();
  if (degrees.empty()) return;
  faults.push_back(
      fmt::format("LiDAR: nothing comes back any more from {} deg of its round, {} deg to the left of its x: clean the "
                  "window; does something hang before it, or is there water or an edge beside the road?",
                  kWidth * static_cast<int>(degrees.size()), fmt::join(arcs(), ", ")));
}

}  // namespace curbstone::mapper::returns
