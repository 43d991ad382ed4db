#include "tools/detect/cloud_file.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/pcd/pcd_header.hpp"
#include "tools/detect/pcd_file.hpp"
#include "tools/detect/ply_file.hpp"

namespace curbstone::detect {

namespace {

namespace fs = std::filesystem;

std::string ending(const fs::path& path) {
  std::string e = path.extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return e;
}

bool is_cloud(const fs::path& path) {
  const std::string e = ending(path);
  return e == ".pcd" || e == ".ply" || e == ".bin";
}

void check_file(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw CloudFileError(fmt::format("{}: no such file", path.string()));
  if (!fs::is_regular_file(path, error)) throw CloudFileError(fmt::format("{}: is not a file", path.string()));
  if (fs::file_size(path, error) == 0) throw CloudFileError(fmt::format("{}: is empty", path.string()));
  if (!std::ifstream(path, std::ios::binary)) throw CloudFileError(fmt::format("{}: cannot be read", path.string()));
}

std::vector<Eigen::Vector3f> read_kitti(const fs::path& path, const Eigen::Vector3d& origin) {
  constexpr std::size_t kRow = 4 * sizeof(float);
  const std::size_t size = fs::file_size(path);
  if (size % kRow != 0)
    throw CloudFileError(
        fmt::format("{}: {} bytes are no whole number of points (x y z intensity as float32): "
                    "truncated, or not a KITTI scan",
                    path.string(), size));
  std::vector<float> values(size / sizeof(float));
  std::ifstream in(path, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(size)))
    throw CloudFileError(fmt::format("{}: cannot be read", path.string()));
  std::vector<Eigen::Vector3f> points;
  points.reserve(size / kRow);
  for (std::size_t i = 0; i < values.size(); i += 4) {
    const Eigen::Vector3d p = Eigen::Vector3f(values[i], values[i + 1], values[i + 2]).cast<double>();
    points.push_back((p - origin).cast<float>());
  }
  return points;
}

std::vector<Eigen::Isometry3d> read_poses(const std::string& path) {
  check_file(path);
  std::ifstream in(path);
  std::vector<Eigen::Isometry3d> poses;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream row(line);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int i = 0; i < 12; ++i) row >> pose.matrix()(i / 4, i % 4);
    std::string more;  // KITTI-360 puts an index before the twelve numbers
    const Eigen::Matrix3d R = pose.linear();
    if (!row || row >> more || !pose.matrix().allFinite() || !(R * R.transpose()).isIdentity(1e-3) ||
        R.determinant() < 0)
      throw CloudFileError(fmt::format("{}:{}: expected 12 numbers, the rows of a 3x4 pose", path, number));
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace

std::vector<Eigen::Vector3f> read_cloud(const std::string& path, const Eigen::Vector3d& origin) {
  if (!std::filesystem::exists(path)) throw CloudFileError(fmt::format("{}: no such file", path));
  if (!is_cloud(path)) throw CloudFileError(fmt::format("{}: is not a .pcd, .ply or KITTI .bin file", path));
  check_file(path);
  std::vector<Eigen::Vector3f> points = ending(path) == ".bin"   ? read_kitti(path, origin)
                                        : ending(path) == ".pcd" ? read_pcd(path, origin)
                                                                 : read_ply(path, origin);
  if (points.empty()) throw CloudFileError(fmt::format("{}: holds no points", path));
  return points;
}

std::vector<Eigen::Vector3f> read_cloud_folder(const std::string& folder, const std::string& poses_file,
                                               double min_range, const Eigen::Vector3d& origin) {
  const std::vector<Eigen::Isometry3d> poses = read_poses(poses_file);
  std::vector<fs::path> scans;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && is_cloud(entry.path())) scans.push_back(entry.path());
  }
  std::sort(scans.begin(), scans.end(),
            [](const fs::path& a, const fs::path& b) { return strverscmp(a.c_str(), b.c_str()) < 0; });
  if (scans.empty()) throw CloudFileError(fmt::format("{}: holds no .pcd, .ply or .bin scans", folder));
  if (scans.size() > poses.size())
    throw CloudFileError(
        fmt::format("{}: {} poses for {} scans in {}", poses_file, poses.size(), scans.size(), folder));
  std::vector<Eigen::Vector3f> points;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    for (const Eigen::Vector3f& p : read_cloud(scans[k].string())) {
      if (static_cast<double>(p.norm()) < min_range) continue;  // non-finite points are kept, to be counted
      points.push_back((poses[k] * p.cast<double>() - origin).cast<float>());
    }
  }
  return points;
}

void write_labelled_pcd(const std::vector<cloud_map::DetectedPoint>& points, const std::string& path) {
  std::ofstream out(path, std::ios::binary);
  constexpr std::array<PcdField, 10> kFields = {
      {{"x"}, {"y"}, {"z"}, {"normal_x"}, {"normal_y"}, {"normal_z"}, {"stick"}, {"plate"}, {"ball"}, {"label", 'U'}}};
  out << pcd_header(kFields, points.size());
  for (const cloud_map::DetectedPoint& p : points) {
    const float values[9] = {p.position.x(), p.position.y(), p.position.z(), p.normal.x(), p.normal.y(),
                             p.normal.z(),   p.stick,        p.plate,        p.ball};
    const auto label = static_cast<std::uint32_t>(p.label);
    out.write(reinterpret_cast<const char*>(values), sizeof values);
    out.write(reinterpret_cast<const char*>(&label), sizeof label);
  }
  out.flush();
  if (!out) throw CloudFileError(fmt::format("{}: cannot be written: {}", path, std::strerror(errno)));
}

}  // namespace curbstone::detect
