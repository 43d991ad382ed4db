#include "tools/evaluate/truth/labelled_scans.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace curbstone::evaluate::truth {

namespace {

/// Exactly twelve numbers a line: a frame's index before them would shift all.
std::vector<Pose> read_poses(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot be read", file));
  std::vector<Pose> poses;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream row(line);
    Pose pose = Pose::Identity();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) row >> pose.matrix()(r, c);
    }
    std::string more;
    const Eigen::Matrix3d R = pose.linear();
    if (!row || row >> more || !is_finite(pose) || !(R * R.transpose()).isIdentity(1e-3) || R.determinant() < 0)
      throw std::runtime_error(fmt::format("{}:{}: expected 12 numbers, the rows of a 3x4 pose", file, number));
    poses.push_back(pose);
  }
  return poses;
}

/// Reads a whole file of `Record`s.
template <class Record>
std::vector<Record> read_records(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot be read", file));
  const auto size = std::filesystem::file_size(file);
  if (size % sizeof(Record) != 0) throw std::runtime_error(fmt::format("{}: cut off", file));
  std::vector<Record> records(size / sizeof(Record));
  in.read(reinterpret_cast<char*>(records.data()), static_cast<std::streamsize>(size));
  return records;
}

/// A scan and its labels, which share the file name without its extension.
struct LabelledScan {
  std::string name;
  Pose T_first_scan = Pose::Identity();
};

/// With poses, a scan's name is its index among them; a single scan may have any name and needs no pose.
std::vector<LabelledScan> find_labelled(const std::string& folder) {
  namespace fs = std::filesystem;
  const std::string labels = folder + "/labels";
  std::vector<LabelledScan> scans;
  if (fs::exists(folder + "/reference_poses.txt")) {
    const std::vector<Pose> poses = read_poses(folder + "/reference_poses.txt");
    for (std::size_t scan = 0; scan < poses.size(); ++scan) {
      const std::string name = fmt::format("{:06}", scan);
      if (fs::exists(fmt::format("{}/{}.label", labels, name))) scans.push_back({name, poses[scan]});
    }
    return scans;
  }
  if (!fs::is_directory(labels)) return scans;
  for (const auto& entry : fs::directory_iterator(labels)) {
    if (entry.path().extension() == ".label") scans.push_back({entry.path().stem().string()});
  }
  if (scans.size() > 1)
    throw std::runtime_error(fmt::format("{}/reference_poses.txt: more than one scan needs poses", folder));
  return scans;
}

}  // namespace

std::vector<LabelledPoint> read_labelled_scans(const std::string& folder, const Pose& T_world_first, double reach) {
  std::vector<LabelledPoint> points;
  for (const auto& [name, T_first_scan] : find_labelled(folder)) {
    const std::string label_file = folder + "/labels/" + name + ".label";
    const auto labels = read_records<std::uint32_t>(label_file);
    const auto returns = read_records<std::array<float, 4>>(folder + "/scans/" + name + ".bin");
    if (labels.size() != returns.size()) {
      throw std::runtime_error(fmt::format("{}: {} labels for {} points", label_file, labels.size(), returns.size()));
    }
    const Pose T_world_scan = T_world_first * T_first_scan;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const Eigen::Vector3d at = Eigen::Vector3f(returns[i][0], returns[i][1], returns[i][2]).cast<double>();
      if (at.norm() < reach) points.push_back({T_world_scan * at, static_cast<std::uint16_t>(labels[i])});
    }
  }
  if (points.empty()) throw std::runtime_error(fmt::format("{}/labels: no labelled scans", folder));
  return points;
}

}  // namespace curbstone::evaluate::truth
