#include <gtest/gtest.h>

#include "tools/bench/curbs/scores/bin_score.hpp"
#include "tools/bench/curbs/scores/curb_feet.hpp"
#include "tools/bench/curbs/scores/street_score.hpp"

namespace curbstone::bench::curbs {
namespace {

const Eigen::Vector3d kEye(0, 0, 1.8);

/// Detections `off` m outside both feet of a scene, x 0..20 m.
std::vector<evaluate::CurbFoot> both_sides(const scenes::CurbScene& scene, double off) {
  std::vector<evaluate::CurbFoot> feet;
  for (double s = 0.05; s < 20; s += 0.1) {
    for (const double y : {scene.options().left + off, -scene.options().right - off}) {
      const Eigen::Vector3d at = scene.place(s, y);
      feet.push_back({{at.x(), at.y()}, {0, y > 0 ? 1.0 : -1.0}});
    }
  }
  return feet;
}

TEST(BinScore, OfThePerfectDetectorIsOne) {
  for (const scenes::CurbSceneOptions& options : scenes::peer_scenes()) {
    const scenes::CurbScene scene(options);
    const scores::BinScore score = scores::score_bins(both_sides(scene, 0.02), scene, {kEye});
    EXPECT_DOUBLE_EQ(score.f1(), 1) << options.name;
    EXPECT_NEAR(score.rmse, 0.02, 1e-6);
    EXPECT_NEAR(score.bias, 0.02, 1e-6);
  }
}

TEST(BinScore, TheInnermostDetectionCounts) {
  const scenes::CurbScene scene({.name = "street"});
  auto feet = both_sides(scene, 0);
  feet.push_back({{10.2, 1.0}, {0, 1}});  // a ghost in mid-road
  const scores::BinScore score = scores::score_bins(feet, scene, {kEye});
  EXPECT_NEAR(score.precision, 79.0 / 80, 1e-9);
  EXPECT_NEAR(score.recall, 79.0 / 80, 1e-9);
}

TEST(BinScore, HalfAMetreOffIsWrongAndNothingIsNothing) {
  const scenes::CurbScene scene({.name = "street"});
  EXPECT_EQ(scores::score_bins(both_sides(scene, 0.4), scene, {kEye}).precision, 0);
  EXPECT_EQ(scores::score_bins(both_sides(scene, 0.4), scene, {kEye}).wrong, 80);
  EXPECT_EQ(scores::score_bins({}, scene, {kEye}).f1(), 0);
}

TEST(BinScore, WhereThereIsNoCurbAllThatIsFoundIsWrong) {
  const scenes::CurbScene scene({.name = "country road", .height = 0, .pavement = 0.15});
  const scores::BinScore score = scores::score_bins(both_sides(scene, 0), scene, {kEye});
  EXPECT_EQ(score.bins, 0);
  EXPECT_EQ(score.wrong, 80);
  EXPECT_EQ(scores::score_bins({}, scene, {kEye}).wrong, 0);
}

TEST(CurbFeet, AreNoFartherApartThanAsked) {
  const semantic_map::tile::CurbLine line{
      .id = 1, .points = {{0, 0, 0, 0.1F, 0, 1}, {1, 0, 0, 0.1F, 0, 1}, {1.05F, 0, 0, 0.1F, 0, 1}}};
  const auto feet = scores::feet_along({line}, 0.1);
  ASSERT_GE(feet.size(), 11U);
  for (std::size_t i = 1; i < feet.size(); ++i) EXPECT_LE(feet[i].at.x - feet[i - 1].at.x, 0.1 + 1e-6);
  EXPECT_NEAR(feet.back().at.x, 1.05, 1e-6);
}

/// A curb along y = 6 with a step of 8 cm, lowered to 2 cm beyond x = 5; ground labelled within 10 m.
evaluate::truth::StreetLabels street_of(double step) {
  evaluate::truth::StreetLabels labels;
  for (double x = -5; x < 8; x += 0.1) labels.curbs.push_back({0, x, 6, 0, x < 5 ? step : 0.02, x >= 5});
  labels.classes = {.resolution = 0.12, .origin_x = -10, .origin_y = -10, .width = 170, .height = 170, .pixels = {}};
  labels.classes.pixels.assign(170 * 170, 1);
  return labels;
}

TEST(StreetScore, TellsRightFromWrongFromWhatDoesNotCount) {
  const evaluate::truth::StreetLabels truth = street_of(0.08);
  EXPECT_EQ(scores::judge({{0, 6.1}, {0, 1}}, truth, 0.12), scores::Verdict::kRight);
  EXPECT_EQ(scores::judge({{0, 6.2}, {0, 1}}, truth, 0.12), scores::Verdict::kWrong);
  EXPECT_EQ(scores::judge({{0, 6.2}, {0, 1}}, truth, 0.24), scores::Verdict::kRight);
  EXPECT_EQ(scores::judge({{6.5, 6.2}, {0, 1}}, truth, 0.12), scores::Verdict::kNotCounted) << "a lowered kerb";
  EXPECT_EQ(scores::judge({{0, 3}, {0, 1}}, truth, 0.24), scores::Verdict::kNotCounted) << "the sensor's blind disc";
  EXPECT_EQ(scores::judge({{0, 20}, {0, 1}}, truth, 0.24), scores::Verdict::kNotCounted) << "no labels there";
}

TEST(StreetScore, StatesBiasAndSpreadApart) {
  const evaluate::truth::StreetLabels truth = street_of(0.08);
  std::vector<evaluate::CurbFoot> feet;
  for (double x = -5; x < 5; x += 0.1) feet.push_back({{x, 6.05}, {0, 1}});
  const scores::StreetScore score = scores::score_street(feet, truth, 0.24);
  EXPECT_NEAR(score.bias, 0.05, 1e-6);
  EXPECT_NEAR(score.spread, 0, 1e-6);
  EXPECT_GT(score.score().f1(), 0.99);
  EXPECT_LT(score.by_step[1].recall, 0.2) << "of the 2 cm steps only those beside the end";
}

TEST(StreetScore, OfSeveralStreetsCountsAllTheirPoints) {
  const scores::StreetScore one{.truth = 10, .found = 9, .detections = 20, .right = 20, .bias = 0.02, .spread = 0.03};
  const scores::StreetScore other{
      .truth = 30, .found = 15, .detections = 20, .right = 10, .bias = -0.01, .spread = 0.05};
  const scores::StreetScore both = scores::pooled({one, other});
  EXPECT_DOUBLE_EQ(both.score().recall, 0.6);
  EXPECT_DOUBLE_EQ(both.score().precision, 0.75);
  EXPECT_DOUBLE_EQ(both.bias, 0.005);
  EXPECT_DOUBLE_EQ(both.spread, 0.04);
}

}  // namespace
}  // namespace curbstone::bench::curbs
