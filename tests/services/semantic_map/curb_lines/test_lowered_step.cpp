#include "services/semantic_map/curb_lines/lowered_step.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace curbstone::semantic_map::curb_lines {
namespace {

constexpr double kLipLength = 4;  // m along x; the higher side is at y > 0
constexpr double kLipOffsets[] = {0.14, 0.26, 0.38, 0.50};

/// A road that bends up along the line and falls towards it, a lip, and a ramp behind it.
double lip_ground(const Eigen::Vector2d& at) {
  const double x = at.x(), y = at.y();
  const double rough = 0.002 * std::sin(37 * x + 91 * y) + 0.002 * std::cos(53 * x - 17 * y);
  return 5 + 0.03 * x + 0.004 * x * x + (y < 0 ? -0.05 * y : 0.02 + 0.08 * y) + rough;
}

std::vector<tile::CurbVertex> lip_line() {
  std::vector<tile::CurbVertex> vertices;
  for (int k = 0; k <= 20; ++k) vertices.push_back({0.2F * static_cast<float>(k), 0, 5, 0.02F, 0, 1});
  return vertices;
}

/// docs/method.md, section 12: all ground beside the line, six unknowns.
LoweredStep lip_by_definition() {
  std::vector<Eigen::Vector2d> places;
  for (const tile::CurbVertex& v : lip_line()) {
    for (const double off : kLipOffsets) places.insert(places.end(), {{double{v.x}, -off}, {double{v.x}, off}});
  }
  const auto n = static_cast<Eigen::Index>(places.size());
  Eigen::MatrixXd rows(n, 6);
  Eigen::VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = places[static_cast<std::size_t>(i)].x(), u = places[static_cast<std::size_t>(i)].y();
    rows.row(i) << 1, t, t * t, std::min(u, 0.0), std::max(u, 0.0), u > 0 ? 1 : 0;
    right(i) = lip_ground(places[static_cast<std::size_t>(i)]);
  }
  const Eigen::VectorXd found = rows.colPivHouseholderQr().solve(right);
  const double rss = (right - rows * found).squaredNorm();
  const double variance = (rows.transpose() * rows).inverse()(5, 5);
  return {found(5), std::sqrt((rss / static_cast<double>(n - 6) + 0.004 * 0.004) * variance)};
}

TEST(LoweredStep, IsTheLeastSquaresFitOfTheMethod) {
  const auto step = find_lowered_step(lip_ground, lip_line());
  ASSERT_TRUE(step);
  EXPECT_NEAR(step->height, lip_by_definition().height, 1e-6);
  EXPECT_NEAR(step->sigma, lip_by_definition().sigma, 1e-6);
  EXPECT_NEAR(step->height, 0.02, 3 * step->sigma);
}

TEST(LoweredStep, IsNoneWhereHalfOfTheLineHasNone) {
  EXPECT_FALSE(find_lowered_step(
      [](const Eigen::Vector2d& at) {
        return std::optional(at.x() > kLipLength / 2 && at.y() > 0 ? 0.03 + 0.001 * at.x() : 0.001 * at.x());
      },
      lip_line()));
}

TEST(LoweredStep, NeedsGroundOnBothSidesOfMostOfTheLine) {
  const auto seen_to = [](double end) {
    return [end](const Eigen::Vector2d& at) {
      return at.y() < 0 || at.x() < end ? std::optional(lip_ground(at)) : std::nullopt;
    };
  };
  EXPECT_FALSE(find_lowered_step(seen_to(0.5 * kLipLength), lip_line()));
  EXPECT_TRUE(find_lowered_step(seen_to(0.8 * kLipLength), lip_line()));
}

}  // namespace
}  // namespace curbstone::semantic_map::curb_lines
