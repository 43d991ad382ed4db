#include "tools/bench/mapping/drives/scan_drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <stdexcept>

#include "tools/simulate/recorded/scan_file.hpp"

namespace curbstone::bench::mapping::drives {
namespace {

constexpr std::int64_t kEpoch = 1'317'000'000'000'000;  // us, of the first scan: the times in the files begin at 0
constexpr std::int64_t kMaxSweepInterval = 100'000;     // us; scans farther apart were thinned out
constexpr float kMinRange = 0.4F, kMaxRange = 120.0F;   // m, as in the assembler

simulate::recorded::ScanSet selected(const simulate::recorded::ScanSet& all, const ScanDrive::Selection& selection) {
  simulate::recorded::ScanSet some = all;
  some.files.clear();
  some.T_first_scan.clear();
  some.times.clear();
  for (std::size_t i = selection.first; i < all.files.size() && some.files.size() < selection.most;
       i += selection.every) {
    some.files.push_back(all.files[i]);
    some.T_first_scan.push_back(all.T_first_scan[i]);
    some.times.push_back(all.times[i]);
  }
  if (some.files.size() < 2)
    throw std::runtime_error(fmt::format("{}: {} of its {} scans are left, a drive has two", all.folder,
                                         some.files.size(), all.files.size()));
  return some;
}

}  // namespace

ScanDrive::ScanDrive(const std::string& folder, const std::string& poses_file, const std::string& times_file,
                     const Selection& selection)
    : scans_(selected(simulate::recorded::find_scans(folder, poses_file, times_file), selection)) {
  for (std::size_t i = 0; i < scans_.files.size(); ++i) {
    truth_.push_back({kEpoch + std::llround(scans_.times[i] * 1e6), scans_.T_first_scan[i]});
  }
  period_ = std::llround(scans_.period() * 1e6);
  sweep_ = std::min(period_, kMaxSweepInterval);
  vehicle.lidar = {0, 0, 0, 0, 0, 0};
  ground = -1.73;
  std::filesystem::path path = std::filesystem::path(folder).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  name = path.filename().string();
}

void ScanDrive::add_odometry(const std::vector<mapper::scan::OdometrySample>& samples) {
  odometry_ = samples;
}

mapper::scan::Scan ScanDrive::scan(std::size_t scan) const {
  const simulate::recorded::ScanFile file = simulate::recorded::read_scan_file(scans_.files[scan]);

  mapper::scan::Scan out;
  out.number = static_cast<std::int32_t>(scan);
  out.start = out.end = truth_[scan].utime;
  if (scans_.swept) {
    out.start -= sweep_ / 2;
    out.end = out.start + sweep_;
  }
  const float sweep = 1e-6F * static_cast<float>(out.end - out.start);
  for (std::size_t i = 0; i < file.positions.size(); ++i) {
    const Eigen::Vector3f& p = file.positions[i];
    const float range = p.norm();
    if (!(range > kMinRange && range < kMaxRange)) continue;
    const float turn = 0.5F * (1 - std::atan2(p.y(), p.x()) / std::numbers::pi_v<float>);
    out.points.push_back({p, std::clamp(turn, 0.0F, 1.0F) * sweep, file.intensities[i], file.rings[i]});
  }
  if (scans_.swept) {
    std::stable_sort(
        out.points.begin(), out.points.end(),
        [](const mapper::scan::LidarPoint& a, const mapper::scan::LidarPoint& b) { return a.time < b.time; });
  }
  return out;
}

void ScanDrive::play(const Take& take) const {
  mapper::scan::OdometryHistory history;
  std::size_t given = 0;
  for (std::size_t n = 0; n < truth_.size(); ++n) {
    const mapper::scan::Scan next = scan(n);
    while (given < odometry_.size() && !history.reaches(next.end)) history.add(odometry_[given++]);
    take(next, history);
    history.forget_before(next.start - 2 * period_);
  }
}

}  // namespace curbstone::bench::mapping::drives
