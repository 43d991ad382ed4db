#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "services/semantic_map/curbs/curb_filter.hpp"
#include "services/semantic_map/curbs/curb_support.hpp"

namespace curbstone::semantic_map::curbs {
namespace {

CurbCandidate step_at(double x, double y, double direction_of_up, double score) {
  CurbCandidate c;
  c.at = {x, y};
  c.up = {std::cos(direction_of_up), std::sin(direction_of_up)};
  c.height = 0.06;
  c.reach = 1.0;
  c.score = score;
  return c;
}

std::vector<double> pooled(const std::vector<CurbCandidate>& candidates) {
  std::vector<PlacedCandidate> placed;
  for (const CurbCandidate& c : candidates) placed.push_back({c.at, c.up, &c});
  const CandidateField field(placed);
  std::vector<double> result;
  for (const PlacedCandidate& c : placed) result.push_back(field.pool_along_line(c));
  return result;
}

constexpr double kUpwards = M_PI / 2;

TEST(CurbSupport, ASingleStepHasItsOwnCertainty) {
  EXPECT_NEAR(pooled({step_at(1, 1, 0.3, 12)}).front(), 12, 1e-9);
}

TEST(CurbSupport, GrowsWithEachPlaceAlongTheLineAndNotWithRepetition) {
  std::vector<CurbCandidate> line = {step_at(0, 0, kUpwards, 10)};
  double before = pooled(line).front();
  for (const double x : {0.5, -0.5, 1.0, -1.0}) {
    line.push_back(step_at(x, 0, kUpwards, 10));
    const double now = pooled(line).front();
    EXPECT_GT(now, before) << x;
    before = now;
  }
  line.push_back(line.back());
  EXPECT_DOUBLE_EQ(pooled(line).front(), before);
}

TEST(CurbSupport, ABendSupportsAlmostLikeAStraightLine) {
  constexpr double kRadius = 6;
  std::vector<CurbCandidate> straight;
  std::vector<CurbCandidate> arc;
  for (double s = -1.5; s <= 1.5; s += 0.3) {
    const double angle = s / kRadius;
    straight.push_back(step_at(s, 0, kUpwards, 10));
    arc.push_back(step_at(kRadius * std::sin(angle), kRadius * (1 - std::cos(angle)), kUpwards + angle, 10));
  }
  const std::size_t middle = straight.size() / 2;
  EXPECT_GT(pooled(arc)[middle], 0.85 * pooled(straight)[middle]);
}

/// docs/method.md, section 11. The frame of a step: up is y, and along is -x.
TEST(CurbSupport, WeighsAStepAlongTheArcAsTheMethodSays) {
  struct Other {
    double along, across, turned;
  };
  for (const Other& o : {Other{0.6, 0.02, 0.03}, {-0.9, 0.05, 0.1}, {1.5, -0.1, 0.02}, {1.9, 0, 0}}) {
    const double beside = o.across / (0.06 + 0.20 * std::abs(o.along));
    const double off = (std::sin(o.turned) + 2 * o.across / o.along) / 0.20;
    const double g = (1 - o.along * o.along / 4) * std::pow((1 - beside * beside) * (1 - off * off), 2);
    ASSERT_GT(g, 0.01);
    const CurbCandidate other = step_at(-o.along, o.across, kUpwards + o.turned, 20);
    EXPECT_NEAR(pooled({step_at(0, 0, kUpwards, 10), other}).front(), std::hypot(10, g * 20), 1e-9) << o.along;
  }
}

TEST(CurbSupport, WhatIsBesideTurnedOrFacesTheOtherWayGivesNone) {
  const auto with = [](const CurbCandidate& other) { return pooled({step_at(0, 0, kUpwards, 10), other}).front(); };
  EXPECT_NEAR(with(step_at(0.6, 0.3, kUpwards, 50)), 10, 1e-9) << "beside";
  EXPECT_NEAR(with(step_at(0.6, 0, kUpwards + 0.5, 50)), 10, 1e-9) << "turned";
  EXPECT_NEAR(with(step_at(0.6, 0, -kUpwards, 50)), 10, 1e-9) << "down where the other goes up";
  EXPECT_NEAR(with(step_at(2.5, 0, kUpwards, 50)), 10, 1e-9) << "far";
}

TEST(CurbSupport, FacesAlongALinePoolHowFarTheyLeanBack) {
  std::vector<CurbCandidate> line;
  for (double x = -1; x <= 1; x += 0.1) {
    line.push_back(step_at(x, 0, kUpwards, 10));
    line.back().lean = {.uz = 0.5 * 0.0005, .zz = 0.0005};
  }
  line.push_back(step_at(0.3, 0.4, kUpwards, 10));
  line.back().lean = {.uz = 10, .zz = 1};  // beside: of another line
  std::vector<PlacedCandidate> placed;
  for (const CurbCandidate& c : line) placed.push_back({c.at, c.up, &c});
  EXPECT_LT(line[10].lean.slope(), 0.25) << "of few points rather upright";
  EXPECT_NEAR(lean_along_line(placed[10], placed), 0.45, 0.04) << "with the evidence of the whole line";
}

/// Of few candidates and of many, which are looked at side by side.
TEST(CurbSupport, DoesNotDependOnCandidatesFarAwayNorOnTheirOrder) {
  std::mt19937 random(1);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<CurbCandidate> all;
  for (int i = 0; i < 500; ++i) all.push_back(step_at(uniform(-3, 6), uniform(-3, 6), uniform(0, 2), uniform(5, 50)));
  const std::vector<double> of_all = pooled(all);
  int num_alone = 0;
  for (std::size_t i = 0; i < all.size(); i += 7) {
    std::vector<CurbCandidate> near = {all[i]};
    for (auto c = all.rbegin(); c != all.rend(); ++c) {
      if ((c->at - all[i].at).norm() < 2.1) near.push_back(*c);
    }
    ASSERT_LT(near.size(), all.size() / 2);
    EXPECT_EQ(pooled(near).front(), of_all[i]);
    num_alone += pooled({all[i]}).front() == of_all[i] ? 1 : 0;
  }
  EXPECT_LT(num_alone, 24) << "of 72: most have others on their lines";
}

/// Scan lines 0.6 m apart cross a curb along y = 1.5. Between each two of them a step can also be put aslant, and with
/// more certainty.
TEST(CurbFilter, StepsThatGoOnAlongTheirOwnDirectionWinOverMoreCertainOnesAslant) {
  std::vector<CurbCandidate> candidates;
  for (double x = 0.2; x < 3; x += 0.6) {
    for (const double dx : {-0.06, 0.06}) {
      candidates.push_back(step_at(x + dx, 1.5, kUpwards, 12));
      candidates.push_back(step_at(x + dx + 0.3, 1.5 + dx, kUpwards - 0.7, 25));
    }
  }
  tile::Around<std::vector<CurbCandidate>> around;
  around.set(0, 0, &candidates);
  const std::vector<CurbPoint> points = filter_curbs(around, {});
  EXPECT_GE(points.size(), 8U) << "of 10";
  for (const CurbPoint& p : points) {
    EXPECT_NEAR(p.foot.y(), 1.5, 1e-9);
    EXPECT_GT(p.up.y(), 0.99);
  }
}

/// A certain line along y = 1.5, and steps that only fall beside every third of its places.
TEST(CurbFilter, WhatOnlyFallsIsNoCurbAndWhereItIsMoreCertainNothingElseIs) {
  for (const double score : {5.0, 60.0}) {
    std::vector<CurbCandidate> candidates;
    for (int k = 0; k < 24; ++k) {
      candidates.push_back(step_at(0.06 + 0.12 * k, 1.5, kUpwards, 12));
      if (k % 3 != 0) continue;
      candidates.push_back(step_at(0.06 + 0.12 * k, 1.7, kUpwards, score));
      candidates.back().falls = true;
    }
    tile::Around<std::vector<CurbCandidate>> around;
    around.set(0, 0, &candidates);
    const std::vector<CurbPoint> points = filter_curbs(around, {});
    for (const CurbPoint& p : points) EXPECT_NEAR(p.foot.y(), 1.5, 1e-9);
    if (score < 12)
      EXPECT_EQ(points.size(), 24U);
    else
      EXPECT_LT(points.size(), 20U);
  }
}

/// A kerb along y = 1.5 m of which all in the tile is lowered, a lip that falls with the ramp behind it; `raised`: what
/// goes on to its left and right is not.
std::vector<CurbPoint> filtered_lowered_kerb(bool raised, double wave) {
  std::vector<CurbCandidate> tiles[3];
  for (std::size_t k = 0; k < 3; ++k) {
    if (k != 1 && !raised) continue;
    for (double x = 0.06; x < 3; x += 0.12) {
      const double score = k == 1 ? 6 : 15;
      tiles[k].push_back(step_at(x, 1.5 + wave * std::sin(40 * x), kUpwards, score));
      tiles[k].back().weak = k == 1;
      tiles[k].back().falls = k == 1;
      tiles[k].back().reach = 0.25;
    }
  }
  tile::Around<std::vector<CurbCandidate>> around;
  for (int dx = -1; dx <= 1; ++dx) around.set(dx, 0, &tiles[dx + 1]);
  return filter_curbs(around, {});
}

TEST(CurbFilter, ALoweredKerbIsFollowedFromItsEnds) {
  const auto points = filtered_lowered_kerb(true, 0);
  EXPECT_GE(points.size(), 24U) << "of 25";
  for (const CurbPoint& p : points) EXPECT_TRUE(p.weak);
}

TEST(CurbFilter, LowStepsByThemselvesAreNoKerbAndNeitherAreScatteredOnes) {
  EXPECT_TRUE(filtered_lowered_kerb(false, 0).empty());
  EXPECT_LT(filtered_lowered_kerb(true, 0.25).size(), 6U);
}

}  // namespace
}  // namespace curbstone::semantic_map::curbs
