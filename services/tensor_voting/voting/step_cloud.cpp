#include "services/tensor_voting/voting/step_cloud.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace curbstone::tensor_voting::voting {

namespace {

/// The median of a sample of the points, axis by axis: outliers do not move it.
Eigen::Vector3d middle_of(std::span<const Eigen::Vector3d> points) {
  constexpr std::size_t kSample = 1000;
  const std::size_t stride = 1 + points.size() / kSample;
  std::array<std::vector<double>, 3> values;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    if (!points[i].allFinite()) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) values[axis].push_back(points[i][static_cast<Eigen::Index>(axis)]);
  }
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  if (values[0].empty()) {
    const auto finite = std::find_if(points.begin(), points.end(), [](const auto& p) { return p.allFinite(); });
    return finite == points.end() ? middle : *finite;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = values[axis].begin() + static_cast<std::ptrdiff_t>(values[axis].size() / 2);
    std::nth_element(values[axis].begin(), at, values[axis].end());
    middle[static_cast<Eigen::Index>(axis)] = *at;
  }
  return middle;
}

}  // namespace

StepCloud to_steps(std::span<const Eigen::Vector3d> points, double sigma, StepCloud room) {
  StepCloud cloud;
  cloud.points = std::move(room.points);
  cloud.source = std::move(room.source);
  cloud.points.clear();
  cloud.source.clear();
  cloud.unit = std::exp2(std::floor(std::log2(sigma)));
  cloud.step = cloud.unit / kStepsPerUnit;
  cloud.origin = middle_of(points);
  cloud.points.reserve(points.size());
  cloud.source.reserve(points.size());
  const double steps_per_metre = 1 / cloud.step;  // a power of two
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) {
      ++cloud.not_finite;
      continue;
    }
    const Eigen::Vector3d steps = (points[i] - cloud.origin) * steps_per_metre;
    if (!(steps.cwiseAbs().maxCoeff() < kMaxUnits * kStepsPerUnit)) {
      ++cloud.too_far;
      continue;
    }
    const auto round = [&](int axis) {  // floor(steps + 1/2)
      const double up = steps[axis] + 0.5;
      const auto whole = static_cast<std::int64_t>(up);
      return whole - (static_cast<double>(whole) > up ? 1 : 0);
    };
    cloud.points.push_back({round(0), round(1), round(2)});
    cloud.source.push_back(i);
  }
  return cloud;
}

}  // namespace curbstone::tensor_voting::voting
