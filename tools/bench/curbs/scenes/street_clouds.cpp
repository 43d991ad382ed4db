#include "tools/bench/curbs/scenes/street_clouds.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "tools/simulate/recorded/scan_set.hpp"

namespace curbstone::bench::curbs::scenes {

namespace {

std::string only_scan(const std::string& folder) {
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  if (fs::is_directory(folder + "/scans")) {
    for (const auto& entry : fs::directory_iterator(folder + "/scans")) {
      if (entry.path().extension() == ".bin") files.push_back(entry.path().string());
    }
  }
  if (files.size() != 1)
    throw std::runtime_error(
        fmt::format("{}: {} scans, and no reference_poses.txt, which more than one needs", folder, files.size()));
  return files.front();
}

std::vector<Eigen::Vector3f> alone(const std::string& file, const Pose& T_world_first, const ScanLoss& loss) {
  std::vector<Eigen::Vector3f> points;
  for (const simulate::recorded::ScanPoint& point : worsened(simulate::recorded::read_scan(file), loss, 0))
    points.push_back((T_world_first * point.position.cast<double>()).cast<float>());
  return points;
}

}  // namespace

std::vector<StreetCloud> read_street_clouds(const std::string& folder, const Pose& T_world_first,
                                            const ScanLoss& loss) {
  constexpr double kBeamSlack = 0.2;  // deg
  std::vector<StreetCloud> clouds{{"merged", {}}, {"frame 0", {}}, {"16 beams", {}}};
  if (!std::filesystem::exists(folder + "/reference_poses.txt"))
    return {{"frame 0", alone(only_scan(folder), T_world_first, loss)}};
  const simulate::recorded::ScanSet scans = simulate::recorded::find_scans(folder, folder + "/reference_poses.txt", "");
  for (std::size_t k = 0; k < scans.files.size(); ++k) {
    const Pose T_world_scan = T_world_first * scans.T_first_scan[k];
    for (const simulate::recorded::ScanPoint& point :
         worsened(simulate::recorded::read_scan(scans.files[k]), loss, k)) {
      const Eigen::Vector3d at = point.position.cast<double>();
      const Eigen::Vector3f p = (T_world_scan * at).cast<float>();
      clouds[0].points.push_back(p);
      if (k == 0) clouds[1].points.push_back(p);
      const double elevation = std::atan2(at.z(), at.head<2>().norm()) * 57.29577951308232;
      const double beam = std::round((elevation + 15) / 2);
      if (beam >= 0 && beam < 16 && std::abs(elevation + 15 - 2 * beam) < kBeamSlack) clouds[2].points.push_back(p);
    }
  }
  return clouds;
}

}  // namespace curbstone::bench::curbs::scenes
