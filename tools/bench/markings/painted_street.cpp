#include "tools/bench/markings/painted_street.hpp"

#include <algorithm>
#include <array>

#include "tools/evaluate/truth/labelled_scans.hpp"
#include "tools/simulate/recorded/laser_scale.hpp"
#include "tools/simulate/recorded/scan_set.hpp"

namespace curbstone::bench::markings {
namespace {

constexpr double kReach = 15.0;          // m: labels are of these scans; farther points are sparse
constexpr double kScannerHeight = 1.73;  // m, of KITTI's car
constexpr int kCuts = 4;                 // one laser in so many

}  // namespace

std::vector<PaintedStreet> read_painted_streets(const std::string& folder) {
  const simulate::recorded::ScanSet scans = simulate::recorded::find_scans(folder, folder + "/reference_poses.txt", "");
  const simulate::recorded::LaserScale scale(scans, kScannerHeight);
  std::vector<PaintedStreet> streets{{"64 beams", {}, {}, {}}};
  streets.resize(1 + kCuts, {"16 beams", {}, {}, {}});
  for (std::size_t k = 0; k < scans.files.size(); ++k) {
    for (const simulate::recorded::ScanPoint& point : simulate::recorded::read_scan(scans.files[k])) {
      const Eigen::Vector3d p = point.position.cast<double>();
      if (p.head<2>().norm() > 2 * kReach) continue;
      for (const std::size_t s : {std::size_t{0}, std::size_t{1} + point.laser % kCuts}) {
        streets[s].points.push_back((scans.T_first_scan[k] * p).cast<float>());
        streets[s].raw.push_back(point.intensity);
        streets[s].by_ring.push_back(scale.table().of(point.laser, point.intensity));
      }
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
