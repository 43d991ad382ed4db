#include "tests/services/mapper/kitti_drive.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace curbstone::test {
namespace {

constexpr std::int64_t kEpoch = 1'317'000'000'000'000;  // us: the drive of 2011
constexpr double kPi = 3.14159265358979323846;

std::string numbered(const std::string& folder, std::size_t scan) {
  std::string digits = std::to_string(scan);
  return folder + "/" + std::string(6 - digits.size(), '0') + digits + ".bin";
}

template <class Value>
std::vector<Value> read_all(const std::string& file) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) return {};
  std::vector<Value> values(static_cast<std::size_t>(in.tellg()) / sizeof(Value));
  in.seekg(0);
  in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(Value)));
  return values;
}

}  // namespace

KittiDrive load_kitti(const std::string& folder) {
  KittiDrive drive;
  drive.folder = folder;
  std::ifstream times(folder + "/times.txt");
  for (double t; times >> t;) drive.stamps.push_back(kEpoch + std::llround(t * 1e6));
  std::ifstream poses(folder + "/reference_poses.txt");
  for (std::string line; std::getline(poses, line);) {
    std::istringstream in(line);
    Pose pose = Pose::Identity();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) in >> pose.matrix()(row, column);
    }
    if (in) drive.reference.push_back(normalised(pose));
  }
  if (drive.stamps.size() > 1) {
    drive.period = (drive.stamps.back() - drive.stamps.front()) / static_cast<std::int64_t>(drive.stamps.size() - 1);
  }
  return drive;
}

std::vector<lidar_points_t> KittiDrive::packets(std::size_t scan) const {
  const std::vector<float> values = read_all<float>(numbered(folder + "/velodyne", scan));
  const std::vector<std::uint8_t> rings = read_all<std::uint8_t>(numbered(folder + "/rings", scan));
  constexpr std::size_t kPackets = 75;
  std::vector<lidar_points_t> out(kPackets);
  const double sweep = static_cast<double>(period) * 1e-6;
  for (std::size_t i = 0; i < kPackets; ++i) {
    out[i].utime =
        stamps[scan] - period / 2 + static_cast<std::int64_t>(i) * period / static_cast<std::int64_t>(kPackets);
    out[i].packet = static_cast<std::int32_t>(scan * kPackets + i);
    out[i].revolution = static_cast<std::int32_t>(scan);
  }
  for (std::size_t i = 0; 4 * i + 3 < values.size(); ++i) {
    const float* v = &values[4 * i];
    const double turn =
        std::clamp(0.5 * (1 - std::atan2(static_cast<double>(v[1]), static_cast<double>(v[0])) / kPi), 0.0, 0.999999);
    const double place = turn * kPackets;
    lidar_points_t& packet = out[static_cast<std::size_t>(place)];
    packet.x.push_back(v[0]);
    packet.y.push_back(v[1]);
    packet.z.push_back(v[2]);
    packet.time_offset.push_back(static_cast<float>((place - std::floor(place)) * sweep / kPackets));
    packet.intensity.push_back(static_cast<std::uint8_t>(std::clamp(v[3], 0.0F, 255.0F)));
    packet.ring.push_back(i < rings.size() ? static_cast<std::uint8_t>(15 - std::min<int>(rings[i], 15))
                                           : std::uint8_t{0});
  }
  for (lidar_points_t& packet : out) packet.num_points = static_cast<std::int32_t>(packet.x.size());
  return out;
}

TrajectoryError compare(const std::vector<Pose>& estimate, const std::vector<Pose>& reference) {
  TrajectoryError error;
  const std::size_t n = std::min(estimate.size(), reference.size());
  if (n < 3) return error;
  std::vector<double> travelled{0};
  for (std::size_t i = 1; i < n; ++i) {
    travelled.push_back(travelled.back() + (reference[i].translation() - reference[i - 1].translation()).norm());
  }
  error.length_m = travelled.back();
  double t_sum = 0;
  double r_sum = 0;
  int count = 0;
  for (double length = 10; length <= 60; length += 10) {
    for (std::size_t i = 0; i < n; ++i) {
      const auto end = std::lower_bound(travelled.begin(), travelled.end(), travelled[i] + length);
      if (end == travelled.end()) break;
      const auto j = static_cast<std::size_t>(end - travelled.begin());
      const Pose delta = (reference[i].inverse() * reference[j]).inverse() * (estimate[i].inverse() * estimate[j]);
      t_sum += delta.translation().norm() / length;
      r_sum += so3_log(Eigen::Quaterniond(delta.linear())).norm() / length;
      ++count;
    }
  }
  if (count > 0) {
    error.t_rel_percent = 100 * t_sum / count;
    error.r_rel_deg_per_m = r_sum / count * 180 / kPi;
  }
  Eigen::Matrix3Xd a(3, static_cast<Eigen::Index>(n));
  Eigen::Matrix3Xd b(3, static_cast<Eigen::Index>(n));
  for (std::size_t i = 0; i < n; ++i) {
    a.col(static_cast<Eigen::Index>(i)) = estimate[i].translation();
    b.col(static_cast<Eigen::Index>(i)) = reference[i].translation();
  }
  const Eigen::Matrix4d T = Eigen::umeyama(a, b, false);
  error.ate_m = std::sqrt(
      ((T.topLeftCorner<3, 3>() * a).colwise() + T.topRightCorner<3, 1>() - b).colwise().squaredNorm().mean());
  const Pose d =
      (reference.front().inverse() * reference[n - 1]).inverse() * (estimate.front().inverse() * estimate[n - 1]);
  error.end_percent = error.length_m > 0 ? 100 * d.translation().norm() / error.length_m : 0;
  return error;
}

}  // namespace curbstone::test
