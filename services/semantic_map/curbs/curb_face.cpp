#include "services/semantic_map/curbs/curb_face.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace curbstone::semantic_map::curbs {

namespace {

constexpr int kMinFacePoints = 3;

/// A point whose height, between the two sides, makes it one of the face: u, height above the low side.
struct FacePoint {
  double u, above;
};

/// The points of the face, as a part of `memory`.
std::span<FacePoint> face_points(const StepWindow& points, const HeightStep& step, std::vector<FacePoint>& memory) {
  constexpr double kNear = 0.15;                                         // m on each side of the step
  if (memory.size() <= points.size()) memory.resize(points.size() + 1);  // one more, which the next one overwrites
  FacePoint* const found = memory.data();
  const double* const at_u = points.u.data();
  const double* const at_t = points.t.data();
  const double* const at_z = points.z.data();
  const HeightStep s = step;
  const double half_length = points.half_length;
  const double lowest = 0.25 * s.height;
  const double highest = 0.75 * s.height;
  const std::size_t num = points.size();
  std::size_t n = 0;
  for (std::size_t i = 0; i < num; ++i) {
    const double u = at_u[i] - s.at;
    const double above = at_z[i] - s.low_z - s.slope.x() * u - s.slope.y() * at_t[i];
    found[n] = {at_u[i], above};
    const bool is_face =
        (std::abs(at_t[i]) <= half_length) & (std::abs(u) <= kNear) & (above > lowest) & (above < highest);
    n += is_face ? 1U : 0U;
  }
  return std::span(memory).first(n);
}

/// The lean of the points near the middle only: noise of the two sides, low before the face and high behind it, would
/// look like a lean.
FaceLean lean_of(std::span<const FacePoint> face, double middle) {
  constexpr double kFace = 0.06;  // m on each side of its middle
  const auto is_of_face = [&](const FacePoint& p) { return std::abs(p.u - middle) < kFace; };
  double n = 0;
  double mean = 0;
  for (const FacePoint& p : face) {
    if (!is_of_face(p)) continue;
    n += 1;
    mean += p.above;
  }
  if (n < kMinFacePoints) return {};
  mean /= n;
  FaceLean lean;
  for (const FacePoint& p : face) {
    if (!is_of_face(p)) continue;
    const double z = p.above - mean;
    lean.add({(p.u - middle) * z, z * z}, 1);
  }
  return lean;
}

}  // namespace

CurbFace find_curb_face(const StepWindow& points, const HeightStep& step) {
  constexpr double kSlack = 0.03;              // m: steps are sought at this spacing
  thread_local std::vector<FacePoint> memory;  // kept for the next call
  const std::span<FacePoint> of_face = face_points(points, step, memory);
  if (of_face.size() < kMinFacePoints) return {step.at, {}};
  const auto middle = of_face.begin() + static_cast<std::ptrdiff_t>(of_face.size() / 2);
  std::nth_element(of_face.begin(), middle, of_face.end(), [](const auto& a, const auto& b) { return a.u < b.u; });
  const double at = std::clamp(middle->u, step.at - kSlack, step.at + kSlack);
  return {at, lean_of(of_face, at)};
}

}  // namespace curbstone::semantic_map::curbs
