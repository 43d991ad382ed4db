#include "services/semantic_map/curbs/curb_face.hpp"

#include <cmath>
#include <vector>

namespace curbstone::semantic_map::curbs {

namespace {

constexpr int kMinFacePoints = 3;

/// Points that are the face's by their height, between the two sides: u, height above the low side.
std::vector<Eigen::Vector2d> face_points(const StepWindow& points, const HeightStep& step) {
  constexpr double kNear = 0.15;  // m on each side of the step
  std::vector<Eigen::Vector2d> of_face;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double u = points.u[i] - step.at;
    if (!points.has(i) || std::abs(u) > kNear) continue;
    const double above = points.z[i] - step.low_z - step.slope.x() * u - step.slope.y() * points.t[i];
    if (above > 0.25 * step.height && above < 0.75 * step.height) of_face.emplace_back(points.u[i], above);
  }
  return of_face;
}

/// Noise of the two sides, low before the face and high behind it, would look like a lean: so only of a kerb's face.
FaceLean lean_of(const std::vector<Eigen::Vector2d>& face, double middle) {
  constexpr double kFace = 0.06;  // m on each side of its middle
  const auto is_of_face = [&](const Eigen::Vector2d& p) { return std::abs(p.x() - middle) < kFace; };
  double n = 0;
  double mean = 0;
  for (const Eigen::Vector2d& p : face) {
    if (!is_of_face(p)) continue;
    n += 1;
    mean += p.y();
  }
  if (n < kMinFacePoints) return {};
  mean /= n;
  FaceLean lean;
  for (const Eigen::Vector2d& p : face) {
    if (!is_of_face(p)) continue;
    const double z = p.y() - mean;
    lean.add({(p.x() - middle) * z, z * z}, 1);
  }
  return lean;
}

}  // namespace

CurbFace find_curb_face(const StepWindow& points, const HeightStep& step) {
  constexpr double kSlack = 0.03;  // m: the grain that a step is sought at
  std::vector<Eigen::Vector2d> of_face = face_points(points, step);
  if (of_face.size() < kMinFacePoints) return {step.at, {}};
  const auto middle = of_face.begin() + static_cast<std::ptrdiff_t>(of_face.size() / 2);
  std::nth_element(of_face.begin(), middle, of_face.end(), [](const auto& a, const auto& b) { return a.x() < b.x(); });
  const double at = std::clamp(middle->x(), step.at - kSlack, step.at + kSlack);
  return {at, lean_of(of_face, at)};
}

}  // namespace curbstone::semantic_map::curbs
