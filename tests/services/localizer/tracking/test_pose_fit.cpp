#include "services/localizer/tracking/pose_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/services/localizer/yard.hpp"

namespace curbstone::localizer::tracking {
namespace {

using test_yard::map_of;
using test_yard::points_in;
using test_yard::pose_at;
using test_yard::Yard;

PoseBelief belief(const Pose& pose) {
  Vector6 sigma;
  sigma << 0.3, 0.3, 0.1, 0.02, 0.02, 0.05;
  return {pose, sigma.cwiseAbs2().asDiagonal()};
}

TEST(FitPose, FindsTheVehicleFromThirtyCentimetresAndTwoDegreesOff) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  const Pose truth = pose_at(1.2, 0.7, 0.4);
  const PoseFit fit = fit_pose({points_in(yard, truth)}, belief(pose_at(1.45, 0.85, 0.435)), map, {});
  const Vector6 error = error_between(truth, fit.belief.T_map_base);
  EXPECT_LT(error.head<2>().norm(), 0.015) << error.transpose();
  EXPECT_LT(std::abs(error(5)), 0.002);
  EXPECT_GT(fit.matched_share(), 0.95);
  EXPECT_EQ(fit.degenerate, 0);
}

TEST(FitPose, SaysThatTwoLongWallsTellNothingLengthwiseAndLeavesThatToThePrior) {
  const Yard yard{.half_length = 60, .turned = 0, .ends = false};
  fields::SavedMap map(map_of(yard));
  const Pose truth = pose_at(0, 0, 0);
  std::vector<Eigen::Vector3d> near;
  for (const Eigen::Vector3d& p : points_in(yard, truth)) {
    if (p.head<2>().norm() < 25) near.push_back(p);
  }
  const PoseFit fit = fit_pose({near}, belief(pose_at(0.2, 0.15, 0)), map, {});
  EXPECT_EQ(fit.degenerate, 1) << "x of base_link, and nothing else";
  EXPECT_NEAR(fit.belief.T_map_base.translation().y(), 0, 0.03) << "walls along the cells: known to a part of one";
  EXPECT_NEAR(fit.belief.T_map_base.translation().x(), 0.2, 0.02);
  EXPECT_GT(std::sqrt(fit.belief.covariance(0, 0)), 0.25) << "known no better than before";
}

TEST(FitPose, ACarWhereTheMapHasNoneDoesNotPull) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  const Pose truth = pose_at(0, 0, 0.3);
  auto points = points_in(yard, truth);
  for (double x = 2; x < 6; x += 0.05) points.emplace_back(x, 1.5, 0.8);
  const PoseFit fit = fit_pose({points}, belief(pose_at(0.1, 0, 0.3)), map, {});
  EXPECT_LT(error_between(truth, fit.belief.T_map_base).head<2>().norm(), 0.015);
}

TEST(FitPose, APacketThatTheBusLostMovesThePoseByAMillimetreAtMost) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  const Pose truth = pose_at(1.2, 0.7, 0.4);
  const auto points = points_in(yard, truth);
  const PoseFit whole = fit_pose({points}, belief(truth), map, {});
  constexpr double kPacket = 6.28 / 38;  // rad, of a revolution of an RS-LiDAR-16 at 20 Hz
  for (double from = -3; from < 2.8; from += 0.5) {
    auto rest = points;
    std::erase_if(rest, [&](const Eigen::Vector3d& p) {
      const double azimuth = std::atan2(p.y(), p.x());
      return azimuth >= from && azimuth < from + kPacket;
    });
    ASSERT_LT(rest.size(), points.size());
    const PoseFit fit = fit_pose({rest}, belief(truth), map, {});
    EXPECT_LT(error_between(whole.belief.T_map_base, fit.belief.T_map_base).head<2>().norm(), 0.001) << from;
  }
}

/// The information of one point at a pose that is known exactly: w J J^T, with Geman and McClure's weight, once all
/// points are used (README.md of the localizer).
Matrix6 information_of(const Eigen::Vector3d& point, const Pose& pose, fields::SavedMap& map) {
  return fit_pose({{point}}, {pose, 1e-12 * Matrix6::Identity()}, map, {}).information;
}
Matrix6 by_equation(double residual, double sigma, double let_go, const Eigen::Vector3d& n, const Eigen::Vector3d& p,
                    const Pose& pose) {
  Vector6 J;
  J << n, p.cross(pose.linear().transpose() * n);
  return J * J.transpose() / (sigma * sigma * std::pow(1 + std::pow(residual / let_go, 2), 2));
}

TEST(FitPose, APointOfTheGroundCountsByItsHeightOverTheMap) {
  fields::SavedMap map(map_of(Yard{.turned = 0}));
  const Pose pose = pose_at(1, 2, 0.3);
  for (const double above : {0.0, 0.03, -0.1}) {
    const Eigen::Vector3d p(3, 1, above);
    const Matrix6 expected = by_equation(above, 0.03, 2 * 0.03, Eigen::Vector3d::UnitZ(), p, pose);
    EXPECT_LT((information_of(p, pose, map) - expected).norm(), 1e-6 * expected.norm()) << above;
  }
}

/// Heights of the map with noise, as a drive measures them.
std::vector<semantic_map::tile::MapTile> with_noise(std::vector<semantic_map::tile::MapTile> tiles, double sigma) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, sigma / kPositionStep);
  for (auto& tile : tiles) {
    for (auto& height : tile.height) {
      if (height != semantic_map::tile::MapTile::kNoHeight)
        height = static_cast<std::int16_t>(std::lround(height + noise(random)));
    }
  }
  return tiles;
}

TEST(FitPose, TheNoiseOfTheMapsGroundIsNoKnowledgeOfThePlaceAlongACurb) {
  for (const double turned : {0.0, 0.4}) {
    const Yard street{.half_length = 60, .turned = turned, .ends = false};
    fields::SavedMap map(with_noise(map_of(street), 0.01));
    const Pose truth = pose_at(0, 0, turned);
    std::vector<Eigen::Vector3d> ground;
    for (const Eigen::Vector3d& p : points_in(street, truth)) {
      if (p.z() < 0.4 && p.head<2>().norm() < 25) ground.push_back(p);
    }
    Pose off = truth;
    off.translation() += truth.linear() * Eigen::Vector3d(0.2, 0.1, 0);
    const PoseFit fit = fit_pose({ground}, belief(off), map, {});
    EXPECT_EQ(fit.degenerate, 1) << "x of base_link, and nothing else";
    const Eigen::Vector3d error =
        truth.linear().transpose() * (fit.belief.T_map_base.translation() - truth.translation());
    EXPECT_NEAR(error.x(), 0.2, 0.01) << "as before: " << turned;
    EXPECT_NEAR(error.y(), 0, 0.08) << "held by the curb, to a part of a cell: " << turned;
    const Eigen::Vector3d along = truth.linear().col(0);
    EXPECT_GT(std::sqrt(along.dot(fit.belief.covariance.topLeftCorner<3, 3>() * along)), 0.28) << "of 0.3 m before";
  }
}

TEST(FitPose, TheEndsOfDashesTellThePlaceAlongAStreet) {
  const Yard street{.half_length = 60, .turned = 0, .ends = false};
  fields::SavedMap map(map_of(street));
  semantic_map::tile::MarkingLine line;
  line.width = 0.12F;
  for (float x = -54; x < 54; x += 9) {
    line.points.push_back({x, 1, 0, true});
    line.points.push_back({x + 3, 1, 0, false});
  }
  map.set_paint(fields::PaintField({line}));
  const Pose truth = pose_at(0, 0, 0);
  ThinnedScan scan{points_in(street, truth)};
  for (double x = -9; x < 9; x += 0.05) {
    for (const double y : {0.96, 1.0, 1.04}) {
      if (x - 9 * std::floor(x / 9) < 3) scan.paint.emplace_back(x, y, 0);
    }
  }
  const PoseFit fit = fit_pose(scan, belief(pose_at(0.2, 0.05, 0)), map, {});
  EXPECT_LT(error_between(truth, fit.belief.T_map_base).head<2>().norm(), 0.06)
      << "the last of the paint is seen up to 5 cm from its end";
  EXPECT_LT(std::sqrt(fit.belief.covariance(0, 0)), 0.15) << "of 0.3 m before";
  TrackingConfig without;
  without.use_paint = false;
  const PoseFit blind = fit_pose(scan, belief(pose_at(0.2, 0.05, 0)), map, without);
  EXPECT_NEAR(blind.belief.T_map_base.translation().x(), 0.2, 0.02);
}

TEST(FitPose, ByPaintAloneOneLineLooksLikeTheNextSoItIsNotUsed) {
  fields::SavedMap map(map_of(Yard{.half_length = 60, .turned = 0, .curb = -100, .ends = false}));
  semantic_map::tile::MarkingLine line;
  line.points = {{-14, 1, 0, true}, {14, 1, 0, false}};
  map.set_paint(fields::PaintField({line}));
  ASSERT_TRUE(map.paint().offset_at(0, 1.4)) << "it is in reach";
  ThinnedScan scan;
  for (double x = -9; x < 9; x += 0.1) {
    scan.paint.emplace_back(x, 1.4, 0);
    for (double y = -4; y < 4; y += 0.5) scan.points.emplace_back(x, y, 0);
  }
  const PoseFit fit = fit_pose(scan, belief(pose_at(0, 0, 0)), map, {});
  EXPECT_NEAR(fit.belief.T_map_base.translation().y(), 0, 1e-3);
  EXPECT_EQ(fit.degenerate & 3, 3);
}

TEST(FitPose, EndsAfterAFewIterationsHoweverFarOffItBegins) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  const Pose truth = pose_at(1.2, 0.7, 0.4);
  const ThinnedScan scan{points_in(yard, truth)};
  ASSERT_GT(scan.points.size(), 1000U) << "first iterations are with a third of them";
  PoseBelief prior = belief(truth);
  prior.covariance *= 100;
  for (double off = 0.5; off < 4; off += 0.5) {
    prior.T_map_base = pose_at(1.2 + off, 0.7 - off, 0.4 + 0.05 * off);
    EXPECT_LE(fit_pose(scan, prior, map, {}).iterations, 5) << off;
  }
}

TEST(FitPose, WithoutPointsStaysWithThePrior) {
  fields::SavedMap map(map_of(Yard{}));
  const PoseFit fit = fit_pose({}, belief(pose_at(0.5, 0, 0)), map, {});
  EXPECT_NEAR(fit.belief.T_map_base.translation().x(), 0.5, 1e-12);
  EXPECT_EQ(fit.matched_share(), 0);
  EXPECT_EQ(fit.degenerate, 63);
}

}  // namespace
}  // namespace curbstone::localizer::tracking
