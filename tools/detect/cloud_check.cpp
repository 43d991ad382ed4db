#include "tools/detect/cloud_check.hpp"

#include <vector>

#include "common/statistics/quantile.hpp"

namespace curbstone::detect {

namespace {

constexpr double kOutliers = 0.02;  // share at either end that is ignored
constexpr double kTall = 2.0;       // m; the orientation of a flatter cloud cannot be told
constexpr double kLopsided = 3.0;

std::vector<double> coordinate(std::span<const Eigen::Vector3f> cloud, Eigen::Index axis) {
  std::vector<double> values;
  values.reserve(cloud.size());
  for (const Eigen::Vector3f& p : cloud) {
    if (p.allFinite()) values.push_back(static_cast<double>(p(axis)));
  }
  return values;
}

}  // namespace

std::optional<Eigen::Vector3d> middle_of(std::span<const Eigen::Vector3f> cloud) {
  Eigen::Vector3d middle;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values = coordinate(cloud, axis);
    if (values.empty()) return std::nullopt;
    middle(axis) = quantile_in_place(values, 0.5);
  }
  return middle;
}

bool seems_upside_down(std::span<const Eigen::Vector3f> cloud) {
  std::vector<double> z = coordinate(cloud, 2);
  if (z.empty()) return false;
  const double middle = quantile_in_place(z, 0.5);
  const double below = middle - quantile_in_place(z, kOutliers);
  const double above = quantile_in_place(z, 1 - kOutliers) - middle;
  return below > kTall && below > kLopsided * above;
}

}  // namespace curbstone::detect
