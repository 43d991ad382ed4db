#include "tools/simulate/recorded/scan_surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace curbstone::simulate::recorded {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kColumn = 0.1 * kDegree;  // width of the azimuth bins
constexpr double kParallax = 7 * kDegree;  // largest change of a near point's bearing from its scan's position
constexpr std::size_t kLoaded = 4;         // scans in memory

double wrap(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

/// Tolerances between points and a beam, by the density of the recording.
struct Nearness {
  float azimuth;  ///< rad
  float nearest;  ///< rad of elevation within which a beam hits a point's own surface
  float apart;    ///< rad: two points at most this far apart have a surface between them
};
Nearness nearness(const ScanSet& scans) {
  constexpr auto kDeg = static_cast<float>(kDegree);
  return scans.swept ? Nearness{0.22F * kDeg, 0.3F * kDeg, 2.5F * kDeg}
                     : Nearness{0.12F * kDeg, 0.15F * kDeg, 0.8F * kDeg};
}

bool is_ground(float height) {
  return height < -1.2F && height > -2.3F;
}

}  // namespace

ScanSurroundings::ScanSurroundings(const ScanSet& scans, const RecordedMotion& motion, const Playback& playback,
                                   const devices::LidarEmulator& lidar, std::shared_ptr<const LaserScale> scale)
    : scans_(scans),
      motion_(motion),
      playback_(playback),
      scale_(std::move(scale)),
      elevations_(lidar.elevations_deg()),
      lens_offset_(lidar.table().lens_offset) {
  for (double& elevation : elevations_) elevation *= kDegree;
}

const ScanSurroundings::LoadedScan& ScanSurroundings::load(std::size_t index) {
  for (const auto& scan : loaded_) {
    if (scan.index == index) return scan;
  }
  LoadedScan scan;
  scan.index = index;
  for (const auto& point : read_scan(scans_.files[index])) {
    const double bearing = std::atan2(static_cast<double>(point.position.y()), static_cast<double>(point.position.x()));
    // KITTI's head turns clockwise and points forward at the scan's time.
    const Pose T =
        scans_.swept ? recorded_pose(scans_, scans_.times[index] - bearing / (2.0 * std::numbers::pi) * scans_.period())
                     : scans_.T_first_scan[index];
    scan.points.push_back({static_cast<float>(bearing), (T * point.position.cast<double>()).cast<float>(),
                           scale_ ? scale_->of(point) : point.intensity});
  }
  std::sort(scan.points.begin(), scan.points.end(), [](const auto& a, const auto& b) { return a.bearing < b.bearing; });
  if (loaded_.size() >= kLoaded) loaded_.pop_front();
  return loaded_.emplace_back(std::move(scan));
}

std::size_t ScanSurroundings::scan_for(double recorded, double bearing) const {
  // The scan whose head pointed that way at about this time.
  const double looked = -bearing / (2.0 * std::numbers::pi) * scans_.period();
  const auto after =
      std::lower_bound(scans_.times.begin(), scans_.times.end(), recorded - looked) - scans_.times.begin();
  const auto high = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(after, 1, static_cast<std::ptrdiff_t>(scans_.times.size()) - 1));
  const double off_low = std::abs(scans_.times[high - 1] + looked - recorded);
  return off_low <= std::abs(scans_.times[high] + looked - recorded) ? high - 1 : high;
}

void ScanSurroundings::prepare(const sensors::PacketView& view) {
  const double middle = view.azimuth + 0.5 * view.azimuth_span;
  const LoadedScan& scan = load(scan_for(playback_.recording_time(view.t), wrap(-middle)));
  columns_.resize(static_cast<std::size_t>(view.azimuth_span / kColumn) + 12);
  for (auto& column : columns_) column.clear();
  first_column_ = view.azimuth - 6 * kColumn;
  origin_ = view.T_world_lidar.translation();
  // The direction of that sector in the scan's own frame.
  const Pose T_scan_lidar = (motion_.T_world_first() * scans_.T_first_scan[scan.index]).inverse() * view.T_world_lidar;
  const double turned = roll_pitch_yaw(T_scan_lidar.linear()).z();
  const double from = wrap(-middle + turned - 0.5 * view.azimuth_span - kParallax);
  const double to = from + view.azimuth_span + 2.0 * kParallax;
  add_points(scan, view, from, to);
  if (to > std::numbers::pi) add_points(scan, view, from - 2.0 * std::numbers::pi, to - 2.0 * std::numbers::pi);
}

void ScanSurroundings::add_points(const LoadedScan& scan, const sensors::PacketView& view, double from, double to) {
  const Eigen::Isometry3f T_lidar_first = (view.T_world_lidar.inverse() * motion_.T_world_first()).cast<float>();
  auto it = std::lower_bound(scan.points.begin(), scan.points.end(), from, [](const FixedPoint& p, double bearing) {
    return static_cast<double>(p.bearing) < bearing;
  });
  for (; it != scan.points.end() && static_cast<double>(it->bearing) <= to; ++it) {
    const Eigen::Vector3f p = T_lidar_first * it->position;
    const double azimuth = std::atan2(-static_cast<double>(p.y()), static_cast<double>(p.x()));
    const auto column = static_cast<long>(std::floor(wrap(azimuth - first_column_) / kColumn));
    if (column < 0 || column >= static_cast<long>(columns_.size())) continue;
    const float reach = std::hypot(p.x(), p.y()) - static_cast<float>(lens_offset_);
    if (reach < 0.5F) continue;
    columns_[static_cast<std::size_t>(column)].push_back(
        {static_cast<float>(azimuth), std::atan2(p.z(), reach), reach, p.z(), it->intensity});
  }
}

devices::LidarShot ScanSurroundings::measure(const sensors::Shot& shot) {
  const Nearness near = nearness(scans_);
  const auto elevation = static_cast<float>(elevations_[static_cast<std::size_t>(shot.laser)]);
  const Candidate* below = nullptr;
  const Candidate* above = nullptr;
  const auto reach = static_cast<long>(static_cast<double>(near.azimuth) / kColumn) + 1;
  const auto middle = static_cast<long>(std::floor(wrap(shot.azimuth - first_column_) / kColumn));
  for (long c = std::max(0L, middle - reach); c <= std::min(middle + reach, static_cast<long>(columns_.size()) - 1);
       ++c) {
    for (const Candidate& candidate : columns_[static_cast<std::size_t>(c)]) {
      const double off = wrap(static_cast<double>(candidate.azimuth) - shot.azimuth);
      if (std::abs(off) > static_cast<double>(near.azimuth)) continue;
      const Candidate*& side = candidate.elevation <= elevation ? below : above;
      if (side == nullptr || std::abs(candidate.elevation - elevation) < std::abs(side->elevation - elevation))
        side = &candidate;
    }
  }
  devices::LidarShot report = meet(below, above, elevation);
  if (report.range_m <= 0) return report;
  // Corrects for the vehicle's motion since prepare().
  const Eigen::Vector3d flat(shot.direction_world.x(), shot.direction_world.y(), 0);
  const Eigen::Vector3d lens = origin_ + lens_offset_ * flat.normalized();
  report.range_m -= static_cast<float>((shot.origin_world - lens).dot(shot.direction_world));
  return report;
}

devices::LidarShot ScanSurroundings::meet(const Candidate* below, const Candidate* above, float elevation) const {
  const Nearness near = nearness(scans_);
  const float slope = std::tan(elevation), stretch = std::sqrt(1.0F + slope * slope);
  const auto off = [&](const Candidate* c) { return c == nullptr ? 1e9F : std::abs(c->elevation - elevation); };
  const Candidate* nearest = off(below) <= off(above) ? below : above;
  if (nearest == nullptr) return {};
  const bool bracketed = below != nullptr && above != nullptr && above->elevation - below->elevation <= near.apart;
  const bool one_surface =
      bracketed && (std::abs(above->height - below->height) < 0.25F || std::abs(above->reach - below->reach) < 0.4F);
  if (one_surface) {
    // The intersection of the beam with the straight line between the two.
    const float dr = above->reach - below->reach, dh = above->height - below->height;
    const float denominator = dh - slope * dr;
    const float f = std::abs(denominator) > 1e-6F
                        ? std::clamp((slope * below->reach - below->height) / denominator, 0.0F, 1.0F)
                        : 0.5F;
    return {(below->reach + f * dr) * stretch, nearest->intensity};
  }
  if (off(nearest) > near.nearest) return {};
  // On the nearest point's own surface: horizontal if it is ground, else vertical.
  if (is_ground(nearest->height) && slope < -0.03F) return {nearest->height / slope * stretch, nearest->intensity};
  return {nearest->reach * stretch, nearest->intensity};
}

}  // namespace curbstone::simulate::recorded
