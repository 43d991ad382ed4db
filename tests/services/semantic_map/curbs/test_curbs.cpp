#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/services/semantic_map/synthetic_ground.hpp"

namespace curbstone::semantic_map::curbs {
namespace {

constexpr double kDensity = 250;

// --- Ground without curbs -------------------------------------------------------------------------------------------

struct Ground {
  const char* name;
  std::function<double(double, double)> height;
};

class CurblessGround : public testing::TestWithParam<Ground> {};

TEST_P(CurblessGround, GivesNoCurbAndIsAllRoad) {
  SyntheticCloud cloud;
  cloud.ground(0, 0, 15, 15, kDensity, GetParam().height);
  const detect::cloud_map::CloudMap map = map_of(cloud);
  EXPECT_TRUE(map.curbs.empty()) << map.curbs.size() << " curb points";
  int road = 0;
  int seen = 0;
  for (const tile::MapTile& tile : map.tiles) {
    for (const tile::CellClass c : tile.cell_class) {
      seen += c != tile::CellClass::kUnknown ? 1 : 0;
      road += c == tile::CellClass::kRoad ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 12'000);
  EXPECT_EQ(road, seen);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, CurblessGround,
    testing::Values(Ground{"Flat", [](double, double) { return 0.0; }},
                    Ground{"Hill10Percent", [](double x, double) { return 0.10 * x; }},
                    Ground{"Crossfall", [](double x, double y) { return 0.02 * x + 0.025 * std::abs(y - 7.5); }},
                    Ground{"RampOf12PercentFromTheFlat", [](double x, double) { return 0.12 * std::max(0.0, x - 7); }},
                    Ground{"LongWave",
                           [](double x, double y) { return 0.15 * std::sin(x * 0.6) + 0.1 * std::cos(y * 0.5); }},
                    Ground{"FarBelow", [](double, double) { return -123.4; }}),
    [](const auto& test) { return std::string(test.param.name); });

// --- Curbs ----------------------------------------------------------------------------------------------------------

struct Curb {
  double height;  // m
  double yaw;     // rad, direction along the curb
  double crossfall;
};

class StraightCurb : public testing::TestWithParam<Curb> {
 protected:
  /// Road on the right of the line through (7.5, 7.5), pavement `height` higher on its left, face in between.
  static SyntheticCloud make(const Curb& curb) {
    SyntheticCloud cloud;
    const Eigen::Vector2d along(std::cos(curb.yaw), std::sin(curb.yaw));
    const Eigen::Vector2d up(-along.y(), along.x());
    const auto height = [=](double x, double y) {
      const double u = (Eigen::Vector2d(x, y) - kCentre).dot(up);
      return curb.crossfall * u + (u > 0 ? curb.height : 0.0);
    };
    cloud.ground(0, 0, 15, 15, kDensity, height);
    const Eigen::Vector2d a = kCentre - 7.0 * along;
    const Eigen::Vector2d b = kCentre + 7.0 * along;
    cloud.face(a.x(), a.y(), b.x(), b.y(), 0, curb.height, kDensity);
    return cloud;
  }
  static inline const Eigen::Vector2d kCentre{7.5, 7.5};
};

TEST_P(StraightCurb, IsFoundAtItsFootWithItsHeightAndNowhereElse) {
  const Curb curb = GetParam();
  const detect::cloud_map::CloudMap map = map_of(make(curb));
  const Eigen::Vector2d along(std::cos(curb.yaw), std::sin(curb.yaw));
  const Eigen::Vector2d up(-along.y(), along.x());
  std::vector<bool> covered(50);  // 0.2 m each, over 10 m
  double sum = 0;
  double sum2 = 0;
  double heights = 0;
  int n = 0;
  for (const detect::cloud_map::CloudCurb& c : map.curbs) {
    const Eigen::Vector2d d = c.foot.head<2>() - kCentre;
    const double t = d.dot(along);
    if (std::abs(t) > 5) continue;
    covered[static_cast<std::size_t>((t + 5) * 4.999)] = true;
    const double u = d.dot(up);
    EXPECT_LT(std::abs(u), 0.12) << "a curb where there is none";
    EXPECT_GT(c.up.dot(up), 0.9);
    sum += u;
    sum2 += u * u;
    heights += c.height;
    ++n;
  }
  ASSERT_GT(n, 20);
  EXPECT_GE(std::count(covered.begin(), covered.end(), true), 45) << "of 50 pieces of 0.2 m";
  EXPECT_LT(std::abs(sum / n), 0.02) << "bias of the foot, m";
  EXPECT_LT(std::sqrt(sum2 / n), 0.035) << "rms of the foot, m";
  EXPECT_NEAR(heights / n, curb.height, 0.012);
  EXPECT_EQ(class_at(map, 7.5 - 2 * up.x(), 7.5 - 2 * up.y()), tile::CellClass::kRoad);
  EXPECT_EQ(class_at(map, 7.5 + 2 * up.x(), 7.5 + 2 * up.y()), tile::CellClass::kRoad) << "pavement is road";
}

INSTANTIATE_TEST_SUITE_P(Heights, StraightCurb,
                         testing::Values(Curb{0.06, 0, 0}, Curb{0.10, 0.3, 0}, Curb{0.15, 1.2, 0.02},
                                         Curb{0.06, 2.5, 0.025}, Curb{0.20, -0.7, 0}),
                         [](const auto& test) {
                           return std::to_string(std::lround(100 * test.param.height)) + "cmYaw" +
                                  std::to_string(std::lround(std::abs(10 * test.param.yaw)));
                         });

TEST(Curbs, AKerbWhoseFaceLeansBackIsReportedAtItsFootToo) {
  SyntheticCloud cloud;  // 10 cm high, 8 cm deep; range noise of 1 cm across, as beams come in flat
  cloud.ground(0, 0, 12, 6, kDensity, [](double, double) { return 0.0; });
  cloud.ground(0, 6.08, 12, 12, kDensity, [](double, double) { return 0.10; });
  for (int i = 0; i < 12 * 60; ++i) {
    const double up = cloud.uniform(0, 1);
    cloud.add(cloud.uniform(0, 12), 6 + 0.08 * up + cloud.uniform(-0.02, 0.02), 0.10 * up);
  }
  double sum = 0;
  int n = 0;
  for (const detect::cloud_map::CloudCurb& c : map_of(cloud).curbs) {
    if (c.foot.x() < 1 || c.foot.x() > 11) continue;
    EXPECT_LT(std::abs(c.foot.y() - 6), 0.08);
    sum += c.foot.y() - 6;
    ++n;
  }
  ASSERT_GT(n, 60);
  EXPECT_LT(std::abs(sum / n), 0.02) << "m; the middle of the face is at 0.04";
}

TEST(Curbs, TiltAndStepAloneFindTheLineToo) {
  SyntheticCloud cloud;
  cloud.ground(0, 0, 12, 12, kDensity, [](double, double y) { return y > 6 ? 0.12 : 0.0; });
  cloud.face(0, 6, 12, 6, 0, 0.12, kDensity);
  for (const bool tilt : {true, false}) {
    detect::cloud_map::CloudMapOptions options;
    options.curb.use_tilt = tilt;
    options.curb.use_step = !tilt;
    const detect::cloud_map::CloudMap map = map_of(cloud, options);
    int near = 0;
    for (const detect::cloud_map::CloudCurb& c : map.curbs) near += std::abs(c.foot.y() - 6) < 0.24 ? 1 : 0;
    EXPECT_GT(near, tilt ? 20 : 60) << (tilt ? "tilt" : "step");
  }
}

TEST(Curbs, BesideAParkedCarAreFound) {
  SyntheticCloud cloud;
  cloud.ground(0, 0, 12, 12, kDensity, [](double, double y) { return y > 6 ? 0.12 : 0.0; });
  cloud.face(0, 6, 12, 6, 0, 0.12, kDensity);
  cloud.box(4, 3.9, 8.2, 5.7, 0.25, 1.45, kDensity);  // 0.3 m from the curb
  const detect::cloud_map::CloudMap map = map_of(cloud);
  int beside = 0;
  for (const detect::cloud_map::CloudCurb& c : map.curbs) {
    EXPECT_LT(std::abs(c.foot.y() - 6), 0.12) << "at x " << c.foot.x();
    beside += c.foot.x() > 4.2 && c.foot.x() < 8.0 ? 1 : 0;
  }
  EXPECT_GT(beside, 24) << "of about 32";
  EXPECT_EQ(class_at(map, 6, 4.8), tile::CellClass::kWall) << "the car";
}

/// Detections along x from 0.5 m on, 8 a metre; how many of them the filter keeps.
std::size_t kept_of_line(double length, double score) {
  std::vector<CurbCandidate> candidates;
  for (double x = 0.5; x <= 0.5 + length; x += 0.125) {
    CurbCandidate c;
    c.at = {x, 1.5};
    c.up = Eigen::Vector2d::UnitY();
    c.height = 0.1;
    c.score = score;
    candidates.push_back(c);
  }
  tile::Around<std::vector<CurbCandidate>> around;
  around.set(0, 0, &candidates);
  return filter_curbs(around, {}).size();
}

TEST(CurbFilter, AShortLineMustBeOfCertainStepsALongOneMayBeOfLessCertain) {
  EXPECT_EQ(kept_of_line(1.0, 5), 0U);
  EXPECT_GE(kept_of_line(1.0, 12), 8U);
  EXPECT_GE(kept_of_line(2.4, 6), 18U);
}

}  // namespace
}  // namespace curbstone::semantic_map::curbs
