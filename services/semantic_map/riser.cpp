#include "services/semantic_map/riser.hpp"

#include <cmath>
#include <vector>

namespace curbstone {

namespace {

constexpr int kMinRiserPoints = 3;

/// Points that are the riser's by their height, between the two sides: u, height above the low side.
std::vector<Eigen::Vector2d> riser_points(const StepWindow& points, const HeightStep& step) {
  constexpr double kNear = 0.15;  // m on each side of the step
  std::vector<Eigen::Vector2d> of_riser;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double u = points.u[i] - step.at;
    if (!points.has(i) || std::abs(u) > kNear) continue;
    const double above = points.z[i] - step.low_z - step.slope.x() * u - step.slope.y() * points.t[i];
    if (above > 0.25 * step.height && above < 0.75 * step.height) of_riser.emplace_back(points.u[i], above);
  }
  return of_riser;
}

/// Noise of the two sides, low before the riser and high behind it, would look like a lean: so only of a kerb's face.
RiserLean lean_of(const std::vector<Eigen::Vector2d>& riser, double middle) {
  constexpr double kFace = 0.06;  // m on each side of its middle
  const auto is_of_face = [&](const Eigen::Vector2d& p) { return std::abs(p.x() - middle) < kFace; };
  double n = 0;
  double mean = 0;
  for (const Eigen::Vector2d& p : riser) {
    if (!is_of_face(p)) continue;
    n += 1;
    mean += p.y();
  }
  if (n < kMinRiserPoints) return {};
  mean /= n;
  RiserLean lean;
  for (const Eigen::Vector2d& p : riser) {
    if (!is_of_face(p)) continue;
    const double z = p.y() - mean;
    lean.add({(p.x() - middle) * z, z * z}, 1);
  }
  return lean;
}

}  // namespace

Riser find_riser(const StepWindow& points, const HeightStep& step) {
  constexpr double kSlack = 0.03;  // m: the grain that a step is sought at
  std::vector<Eigen::Vector2d> of_riser = riser_points(points, step);
  if (of_riser.size() < kMinRiserPoints) return {step.at, {}};
  const auto middle = of_riser.begin() + static_cast<std::ptrdiff_t>(of_riser.size() / 2);
  std::nth_element(of_riser.begin(), middle, of_riser.end(),
                   [](const auto& a, const auto& b) { return a.x() < b.x(); });
  const double at = std::clamp(middle->x(), step.at - kSlack, step.at + kSlack);
  return {at, lean_of(of_riser, at)};
}

}  // namespace curbstone
