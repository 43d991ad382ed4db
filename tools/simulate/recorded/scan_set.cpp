#include "tools/simulate/recorded/scan_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tools/simulate/recorded/scan_file.hpp"

namespace curbstone::simulate::recorded {

namespace fs = std::filesystem;

namespace {

std::vector<std::string> scans_in(const fs::path& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".bin") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end(),  // 2.bin before 10.bin
            [](const std::string& a, const std::string& b) { return strverscmp(a.c_str(), b.c_str()) < 0; });
  return files;
}

std::vector<double> numbers_of(const std::string& line) {
  std::istringstream words(line);
  std::vector<double> numbers;
  for (double number = 0; words >> number;) numbers.push_back(number);
  if (!words.eof()) numbers.clear();  // something that is no number
  return numbers;
}

/// Exactly twelve numbers: KITTI-360 puts an index before them, which would shift all.
std::vector<Pose> read_poses(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(fmt::format("--poses {}: cannot be read", file));
  std::vector<Pose> poses;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::vector<double> numbers = numbers_of(line);
    Pose T = Pose::Identity();
    for (int i = 0; i < 12 && numbers.size() == 12; ++i) T(i / 4, i % 4) = numbers[static_cast<std::size_t>(i)];
    const Eigen::Matrix3d R = T.linear();
    if (numbers.size() != 12 || !is_finite(T) || !(R * R.transpose()).isIdentity(1e-3) || R.determinant() < 0)
      throw std::runtime_error(fmt::format("{}:{}: expected 12 numbers, a 3x4 pose row by row", file, number));
    poses.push_back(normalised(T));
  }
  return poses;
}

/// The poses of a camera, as in KITTI odometry, have z ahead: the first metres would go straight up.
void refuse_camera_poses(const std::vector<Pose>& poses, const std::string& file) {
  constexpr double kWay = 5.0;    // m
  constexpr double kSteep = 0.7;  // of the way, upwards: 45 deg
  for (const Pose& T : poses) {
    const Eigen::Vector3d way = poses.front().inverse() * T.translation();
    if (way.norm() < kWay) continue;
    if (std::abs(way.z()) < kSteep * way.norm()) return;
    throw std::runtime_error(fmt::format(
        "{}: its first metres go along z: these are a camera's poses, not the LiDAR's (see docs/tutorial.md)", file));
  }
}

std::vector<double> read_times(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(fmt::format("--times {}: cannot be read", file));
  std::vector<double> times;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::vector<double> numbers = numbers_of(line);
    if (numbers.size() != 1 || !std::isfinite(numbers[0]))
      throw std::runtime_error(fmt::format("{}:{}: expected one number, a time in s", file, number));
    if (!times.empty() && numbers[0] <= times.back())
      throw std::runtime_error(fmt::format("{}:{}: times must increase", file, number));
    times.push_back(numbers[0]);
  }
  constexpr double kMaxInterval = 10;  // s between scans
  if (times.size() > 1 && times.back() - times.front() > kMaxInterval * static_cast<double>(times.size() - 1)) {
    throw std::runtime_error(fmt::format("{}: its scans are {:.0f} s apart; times are in s", file,
                                         (times.back() - times.front()) / static_cast<double>(times.size() - 1)));
  }
  return times;
}

}  // namespace

ScanSet find_scans(const std::string& folder, const std::string& poses_file, const std::string& times_file) {
  ScanSet set;
  set.folder = folder;
  if (!fs::is_directory(folder)) throw std::runtime_error(fmt::format("--scans {}: no such folder", folder));
  fs::path scans = folder;
  for (const char* below : {"", "velodyne", "scans"}) {
    scans = fs::path(folder) / below;
    if (!scans.has_filename()) scans = scans.parent_path();  // a trailing slash, as in "velodyne/", is removed
    set.files = scans_in(scans);
    if (!set.files.empty()) break;
  }
  if (set.files.empty())
    throw std::runtime_error(fmt::format("--scans {}: holds no *.bin, nor does velodyne/ or scans/ in it", folder));
  set.T_first_scan = read_poses(poses_file);
  refuse_camera_poses(set.T_first_scan, poses_file);
  const std::string beside = (fs::path(poses_file).parent_path() / "times.txt").string();
  if (!times_file.empty() || fs::exists(beside)) set.times = read_times(times_file.empty() ? beside : times_file);

  const std::size_t n = std::min(set.files.size(), set.T_first_scan.size());
  if (n < 2)
    throw std::runtime_error(fmt::format("{} scans and {} poses: at least two of each are needed", set.files.size(),
                                         set.T_first_scan.size()));
  if (set.times.empty()) {
    for (std::size_t i = 0; i < n; ++i) set.times.push_back(0.1 * static_cast<double>(i));
  }
  if (set.times.size() < n) throw std::runtime_error(fmt::format("{} times for {} scans", set.times.size(), n));
  set.files.resize(n);
  set.T_first_scan.resize(n);
  set.times.resize(n);
  const double first = set.times.front();
  for (double& t : set.times) t -= first;
  set.swept = fs::is_directory(scans.parent_path() / "rings") || fs::is_directory(scans / "rings");
  return set;
}

std::vector<ScanPoint> read_scan(const std::string& file) {
  const ScanFile scan = read_scan_file(file);
  std::vector<ScanPoint> points;
  points.reserve(scan.positions.size());
  for (std::size_t i = 0; i < scan.positions.size(); ++i) {
    const Eigen::Vector3f& p = scan.positions[i];
    if (!p.allFinite() || p.squaredNorm() < 1.0F || p.squaredNorm() > 1e6F) continue;
    points.push_back({p, scan.intensities[i], scan.rings[i]});
  }
  return points;
}

}  // namespace curbstone::simulate::recorded
