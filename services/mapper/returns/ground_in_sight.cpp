#include "services/mapper/returns/ground_in_sight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace curbstone::mapper::returns {
namespace {

constexpr float kOwn = 0.3F;         // m from the LiDAR: closer returns are of its own window
constexpr float kUneven = 0.15F;     // m by which ground may be off z = 0 anywhere,
constexpr float kSlope = 0.06F;      // and more per metre of distance
constexpr float kTall = 0.15F;       // m above that: not ground
constexpr float kOverhead = 2.2F;    // m: objects higher than this hide no ground
constexpr float kBefore = 1.0F;      // m in front of a tall object: a closer return may be part of the object
constexpr int kFewReturns = 15;      // of a sector: the vehicle hides it, or it is not scanned
constexpr int kGround = 8;           // returns: a third of one laser's
constexpr int kMinOpenSectors = 6;   // sectors that a look needs
constexpr int kMinSectorsAhead = 2;  // sectors
constexpr int kAheadSectors = 4;     // to each side of x

struct Sector {
  int returns = 0;
  float tall = std::numeric_limits<float>::infinity();  // m
  std::vector<float> ground;                            // m, up to which its height identifies it
};

std::size_t sector_of(const Eigen::Vector3f& p) {
  const float turn = std::atan2(p.y(), p.x()) / (2 * std::numbers::pi_v<float>);
  return static_cast<std::size_t>(std::floor((turn + 1) * GroundInSight::kSectors)) % GroundInSight::kSectors;
}

}  // namespace

GroundInSight::GroundInSight(const Pose& T_base_lidar)
    : T_base_lidar_(T_base_lidar.cast<float>()),
      open_until_(std::max(12.0F, 5.0F * T_base_lidar_.translation().z())),
      far_(std::max(20.0F, 8.0F * T_base_lidar_.translation().z())) {}

/// Returns true when the ground has just been lost.
bool GroundInSight::Sight::loses(int now_open, int now_seeing) {
  constexpr double kKept = 1.0 - 1.0 / kLooks;
  open = kKept * open + now_open;
  seeing = kKept * seeing + now_seeing;
  looks = std::min(looks + 1, kLooks);
  if (looks < kLooks) return false;
  const bool before = missing;
  missing = share() < (missing ? kEnough : kFew);
  return missing && !before;
}

void GroundInSight::check(const scan::Scan& scan, bool moved) {
  const bool due = revolution_++ % kEvery == 0;
  if ((!due && !moved) || T_base_lidar_.translation().z() < static_cast<float>(kLowest)) return;
  std::array<Sector, kSectors> sectors;
  for (const scan::LidarPoint& point : scan.points) {
    if (!point.position.allFinite() || !(point.position.squaredNorm() > kOwn * kOwn)) continue;
    const Eigen::Vector3f p = T_base_lidar_ * point.position;
    const float range = p.head<2>().norm();
    const float ground = kUneven + kSlope * range;
    Sector& sector = sectors[sector_of(p)];
    ++sector.returns;
    if (p.z() > ground + kTall && p.z() < kOverhead) sector.tall = std::min(sector.tall, range);
    if (std::abs(p.z()) < ground && range > kNear && range < far_) sector.ground.push_back(range);
  }
  if (due) judge_upside_down(scan);
  int open = 0, seeing = 0, open_ahead = 0, seeing_ahead = 0;
  for (int i = 0; i < kSectors; ++i) {
    const Sector& sector = sectors[static_cast<std::size_t>(i)];
    if (sector.returns < kFewReturns || sector.tall < open_until_) continue;
    const auto is_before = [&](float range) { return range < sector.tall - kBefore; };
    const int sees = std::count_if(sector.ground.begin(), sector.ground.end(), is_before) >= kGround ? 1 : 0;
    ++open;
    seeing += sees;
    if (i >= kAheadSectors && i < kSectors - kAheadSectors) continue;
    ++open_ahead;
    seeing_ahead += sees;
  }
  const bool lost = due && open >= kMinOpenSectors && about_.loses(open, seeing);
  const bool lost_ahead = moved && open_ahead >= kMinSectorsAhead && ahead_.loses(open_ahead, seeing_ahead);
  if (lost || lost_ahead) counters_.add("faults.no_ground");
}

/// Counts ground returns in front of tall objects, as if the LiDAR hung the other way round if `upside_down`.
std::ptrdiff_t GroundInSight::count_ground(const scan::Scan& scan, bool upside_down) const {
  const float lidar = T_base_lidar_.translation().z();
  std::array<float, kSectors> tall;
  tall.fill(std::numeric_limits<float>::infinity());
  std::vector<std::pair<std::size_t, float>> ground;  // sector, m
  for (const scan::LidarPoint& point : scan.points) {
    if (!point.position.allFinite() || !(point.position.squaredNorm() > kOwn * kOwn)) continue;
    const Eigen::Vector3f p = T_base_lidar_ * point.position;
    const float z = upside_down ? 2.0F * lidar - p.z() : p.z();
    const float range = p.head<2>().norm();
    const float uneven = kUneven + kSlope * range;
    const std::size_t sector = sector_of(p);
    if (z > uneven + kTall && z < kOverhead) tall[sector] = std::min(tall[sector], range);
    if (std::abs(z) < uneven && uneven < 0.5F * lidar) ground.emplace_back(sector, range);
  }
  return std::ranges::count_if(ground, [&](const auto& seen) { return seen.second < tall[seen.first] - kBefore; });
}

void GroundInSight::judge_upside_down(const scan::Scan& scan) {
  const auto above = static_cast<double>(count_ground(scan, true));
  const bool is_so = above > kManyAbove * static_cast<double>(scan.points.size()) &&
                     static_cast<double>(count_ground(scan, false)) < kFewBelow * above;
  looks_upside_down_ = std::clamp(looks_upside_down_ + (is_so ? 1 : -1), 0, kLooks);
  if (!is_upside_down_ && looks_upside_down_ == kLooks) counters_.add("faults.lidar.upside_down");
  is_upside_down_ = looks_upside_down_ == kLooks || (is_upside_down_ && looks_upside_down_ > 0);
}

void GroundInSight::add_faults(std::vector<std::string>& faults) const {
  if (is_upside_down_) {
    faults.emplace_back(
        "LiDAR: it is upside down by what vehicle.lidar says, for the ground is above it: add 3.1416 to its roll");
    return;
  }
  if (!about_.missing && !ahead_.missing) return;
  const Sight& sight = about_.missing ? about_ : ahead_;
  faults.push_back(
      fmt::format("LiDAR: no ground in sight beyond {:.0f} m in {:.0f} % of the open directions {}, so no curbs are "
                  "found there: is it tilted up, the lower half of its window dirty, the road wet or under snow?",
                  kNear, 100 * (1 - sight.share()), about_.missing ? "about it" : "ahead"));
}

}  // namespace curbstone::mapper::returns
