#include "tools/bench/markings/painted_street.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/statistics/quantile.hpp"
#include "tools/evaluate/truth/labelled_scans.hpp"
#include "tools/simulate/recorded/scan_set.hpp"

namespace curbstone::bench::markings {
namespace {

constexpr double kReach = 15.0;   // m: labels are of these scans, farther ones are thin
constexpr double kLowest = -2.1;  // m in the lidar's frame: the ground of a car's scanner
constexpr double kHighest = -1.4;
constexpr double kRoadMedian = 64;
constexpr int kRings = 64;

/// KITTI's points are stored laser by laser, each counter-clockwise from ahead: a laser ends where the bearing falls.
std::vector<int> rings_of(const std::vector<simulate::recorded::ScanPoint>& scan) {
  std::vector<int> rings;
  int ring = 0;
  double before = 0;
  for (const auto& point : scan) {
    double bearing = std::atan2(double{point.position.y()}, double{point.position.x()});
    if (bearing < 0) bearing += 2 * std::numbers::pi;
    if (bearing < before - std::numbers::pi) ++ring;
    before = bearing;
    rings.push_back(std::min(ring, kRings - 1));
  }
  return rings;
}

}  // namespace

std::vector<PaintedStreet> read_painted_streets(const std::string& folder) {
  struct Return {
    Eigen::Vector3f at;
    int ring;
    std::uint8_t intensity;
  };
  std::vector<Return> returns;
  std::array<std::vector<double>, kRings> of_ground;
  const simulate::recorded::ScanSet scans = simulate::recorded::find_scans(folder, folder + "/reference_poses.txt", "");
  for (std::size_t k = 0; k < scans.files.size(); ++k) {
    const auto scan = simulate::recorded::read_scan(scans.files[k]);
    const std::vector<int> rings = rings_of(scan);
    for (std::size_t i = 0; i < scan.size(); ++i) {
      const Eigen::Vector3d p = scan[i].position.cast<double>();
      if (p.head<2>().norm() > 2 * kReach) continue;
      returns.push_back({(scans.T_first_scan[k] * p).cast<float>(), rings[i], scan[i].intensity});
      if (p.z() > kLowest && p.z() < kHighest)
        of_ground[static_cast<std::size_t>(rings[i])].push_back(double{static_cast<double>(scan[i].intensity)});
    }
  }
  std::array<double, kRings> shift{};
  for (std::size_t r = 0; r < of_ground.size(); ++r)
    shift[r] = kRoadMedian - quantile_or(of_ground[r], 0.5, kRoadMedian);
  std::vector<PaintedStreet> streets{{"64 beams", {}, {}, {}}, {"16 beams", {}, {}, {}}};
  for (const Return& r : returns) {
    const double moved = std::clamp(r.intensity + shift[static_cast<std::size_t>(r.ring)], 1.0, 255.0);
    for (std::size_t s = 0; s < streets.size(); ++s) {
      if (s == 1 && r.ring % 4 != 0) continue;
      streets[s].points.push_back(r.at);
      streets[s].raw.push_back(r.intensity);
      streets[s].by_ring.push_back(static_cast<std::uint8_t>(std::lround(moved)));
    }
  }
  return streets;
}

PaintTruth read_street_paint(const std::string& folder) {
  constexpr std::uint16_t kMarking = 60;
  constexpr std::array<std::uint16_t, 4> kGround = {40, 44, 48, 60};
  PaintTruth truth;
  for (const evaluate::truth::LabelledPoint& point :
       evaluate::truth::read_labelled_scans(folder, Pose::Identity(), kReach)) {
    const auto label = static_cast<std::uint16_t>(point.label & 0xffff);
    if (label == kMarking) truth.painted.insert(cell_of(point.at.head<2>()));
    if (std::find(kGround.begin(), kGround.end(), label) != kGround.end())
      truth.judged.insert(cell_of(point.at.head<2>()));
  }
  return truth;
}

}  // namespace curbstone::bench::markings
