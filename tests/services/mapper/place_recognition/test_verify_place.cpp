#include "services/mapper/place_recognition/verify_place.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <numbers>

#include "services/mapper/registration/normal_equations.hpp"
#include "services/mapper/scan/downsample.hpp"
#include "tests/paths.hpp"
#include "tests/services/mapper/synthetic_world.hpp"
#include "tools/bench/mapping/drives/scan_drive.hpp"

namespace curbstone::mapper::place_recognition {
namespace {

using test::pose;
constexpr double kPi = std::numbers::pi;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

scan::Keyframe node_of(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base) {
  scan::Keyframe node;
  node.T_map_base = T_map_base;
  std::vector<scan::KeyframePoint> kept;
  for (const scan::LidarPoint& p : scan::downsample(points, 0.2, 60)) {
    if (const auto packed = scan::pack(p.position)) kept.push_back(*packed);
  }
  node.points = std::move(kept);
  return node;
}

/// A world with nodes along x.
struct Remembered {
  test::SyntheticWorld world;
  std::vector<scan::Keyframe> nodes;
  Eigen::Vector3d lidar = test::default_lidar().translation();

  Remembered(test::SyntheticWorld of, double from, double to, double spacing = 2) : world(std::move(of)) {
    world.noise = 0.02;
    for (double x = from; x <= to; x += spacing)
      nodes.push_back(node_of(scan_at(test::pose(x, 0, 0, 0, 0, 0)), test::pose(x, 0, 0, 0, 0, 0)));
  }
  [[nodiscard]] std::vector<scan::LidarPoint> scan_at(const Pose& T) const {
    return world.snapshot(T, test::default_lidar());
  }
  [[nodiscard]] std::vector<const scan::Keyframe*> all() const {
    std::vector<const scan::Keyframe*> out;
    for (const scan::Keyframe& node : nodes) out.push_back(&node);
    return out;
  }
  [[nodiscard]] std::optional<PlaceMatch> find(const std::vector<scan::LidarPoint>& points,
                                               const PlaceGuess& guess) const {
    return verify_place(points, guess, all(), config::IcpConfig{}, lidar);
  }
  [[nodiscard]] std::optional<PlaceMatch> find_globally(const std::vector<scan::LidarPoint>& points) const {
    ScanContext index;
    for (std::size_t i = 0; i < nodes.size(); ++i) index.add(static_cast<int>(i), *nodes[i].points.read());
    return verify_place(points, Pose::Identity(), index, all(), config::IcpConfig{}, lidar);
  }
};

/// Houses all alike, `period` m apart, on both sides of an endless street.
test::SyntheticWorld terrace(double period) {
  test::SyntheticWorld world;
  for (double x = -30 * period; x < 30 * period; x += period) {
    world.boxes.push_back({{x, 7, 0}, {x + 0.6 * period, 15, 7}});
    world.boxes.push_back({{x + 0.2 * period, -16, 0}, {x + 0.7 * period, -8, 7}});
    world.boxes.push_back({{x + 0.8 * period, 4, 0}, {x + 0.8 * period + 0.3, 4.3, 4}});
  }
  return world;
}

double error(const Pose& T, const PlaceMatch& match) {
  return registration::log_of(T.inverse() * match.registration.T_map_base).norm();
}

TEST(VerifyPlace, FindsWhereAScanWasTakenFromMetresOff) {
  const Remembered street(test::street(), -20, 20);
  for (const double yaw : {0.0, kPi}) {
    for (const Eigen::Vector2d& off : {Eigen::Vector2d(0, 0), Eigen::Vector2d(4, -2), Eigen::Vector2d(-3, 3.5)}) {
      const Pose T = test::pose(3.3, 1.2, 0, 0, 0, 0.1 + yaw);
      const PlaceGuess guess{test::pose(3.3 + off.x(), 1.2 + off.y(), 0.8, 0.01, -0.01, yaw - 0.15), 5, 0.35};
      const auto match = street.find(street.scan_at(T), guess);
      ASSERT_TRUE(match);
      EXPECT_LT(error(T, *match), 0.05);
      EXPECT_GT(match->score, 0.9);
      EXPECT_LT(match->conflict, 0.2);
      EXPECT_GT(match->runner_up, 0.5) << "plain walls look alike from further along";
      EXPECT_LT(match->runner_up, match->score);
      EXPECT_LT(match->registration.covariance.diagonal().maxCoeff(), 0.01);
    }
  }
}

TEST(VerifyPlace, IsNotMisledByCarsThatStandThereNow) {
  const Remembered street(test::street(), -20, 20);
  test::SyntheticWorld now = street.world;
  for (const double x : {-9.0, -3.5, 2.0, 7.5, 13.0}) {
    now.boxes.push_back({{x, 2.3, 0.25}, {x + 4.4, 4.1, 1.6}});
    now.boxes.push_back({{x + 1, -4, 0.25}, {x + 5.4, -2.2, 1.6}});
  }
  const Pose T = test::pose(1.3, 0, 0, 0, 0, 0.1);
  const PlaceGuess guess{test::pose(3, 1, 0.5, 0, 0, 0), 5, 0.2};
  CandidateSearch search(street.all(), guess, config::IcpConfig{}, street.lidar);
  const auto hypotheses = search.hypotheses(now.snapshot(T, test::default_lidar()), 1);
  ASSERT_EQ(hypotheses.size(), 1U);
  EXPECT_LT(registration::log_of(T.inverse() * hypotheses[0].T_map_base).norm(), 0.3);
  EXPECT_NEAR(hypotheses[0].T_map_base.translation().z(), 0, 0.05) << "ground on ground, not car on ground";
}

/// Houses of which no two look alike, and a map that ends: beyond x = 6 m nothing was seen from its nodes.
Remembered half_a_suburb() {
  test::SyntheticWorld world;
  for (int i = 0; i < 12; ++i) {
    const double x = -30 + 8 * i, shift = i * 3 % 4, left = 6 + i * 7 % 5, right = 6 + i * 2 % 3, wide = 3 + i * 5 % 4;
    world.boxes.push_back({{x, left, 0}, {x + wide, left + 8, 6}});
    world.boxes.push_back({{x + shift, -right - 8, 0}, {x + shift + wide / 2 + 2, -right, 6}});
  }
  Remembered street(world, -20, -6);
  street.nodes.clear();
  for (double x = -20; x <= -6; x += 2) {
    const Pose T = test::pose(x, 0, 0, 0, 0, 0);
    std::vector<scan::LidarPoint> seen = street.scan_at(T);
    std::erase_if(seen, [&](const scan::LidarPoint& p) { return double{p.position.x()} + x > 6; });
    street.nodes.push_back(node_of(seen, T));
  }
  return street;
}

TEST(VerifyPlace, BeyondTheMapsEndAPartOfWhatIsSeenIsEnoughIfNothingContradictsIt) {
  const Remembered street = half_a_suburb();
  const auto find_part = [&](const std::vector<scan::LidarPoint>& points, double x) {
    return verify_place(points, {test::pose(x - 4, 0, 0.4, 0, 0, 0), 8, 0.35}, street.all(), config::IcpConfig{},
                        street.lidar, Known::kPart);
  };
  const Pose T = test::pose(-4, 0.5, 0, 0, 0, 0.1);
  const auto match = find_part(street.scan_at(T), -4);
  ASSERT_TRUE(match);
  EXPECT_LT(error(T, *match), 0.05);
  EXPECT_FALSE(street.find(street.scan_at(T), {T, 8, 0.35})) << "too little to be sure of a loop";
  EXPECT_FALSE(find_part(street.scan_at(test::pose(4, 0.5, 0, 0, 0, 0.1)), 4)) << "nearly all is new";
  const Remembered elsewhere(test::street(), 0, 0);
  for (double x = -20; x < 0; x += 4) EXPECT_FALSE(find_part(elsewhere.scan_at(test::pose(x, 0, 0, 0, 0, 0)), x)) << x;
}

TEST(VerifyPlace, FindsItWithNothingKnownButTheAttitude) {
  const Remembered street(test::street(), -20, 20);
  for (const double yaw : {0.5, -2.5}) {
    const Pose T = test::pose(-7.4, -1, 0, 0, 0, yaw);
    const auto match = street.find_globally(street.scan_at(T));
    ASSERT_TRUE(match);
    EXPECT_LT(error(T, *match), 0.05);
  }
}

TEST(VerifyPlace, GivesTheSameBitsAgain) {
  const Remembered street(test::street(), -20, 20);
  const auto scan = street.scan_at(test::pose(1, 1, 0, 0, 0, 0.2));
  const PlaceGuess guess{test::pose(3, 0, 0, 0, 0, 0), 5, 0.35};
  const auto first = street.find(scan, guess), second = street.find(scan, guess);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(0, std::memcmp(first->registration.T_map_base.matrix().data(),
                           second->registration.T_map_base.matrix().data(), 16 * sizeof(double)));
  EXPECT_EQ(first->score, second->score);
  EXPECT_EQ(first->conflict, second->conflict);
}

TEST(VerifyPlace, RefusesATunnelAndAnOpenSquare) {
  const Remembered tunnel(test::tunnel(), -20, 20);
  EXPECT_FALSE(tunnel.find(tunnel.scan_at(test::pose(0.5, 0, 0, 0, 0, 0)), {test::pose(0, 0, 0, 0, 0, 0), 5, 0.2}));
  EXPECT_FALSE(tunnel.find_globally(tunnel.scan_at(test::pose(0.5, 0, 0, 0, 0, 0))));
  const Remembered plain(test::plain(), -20, 20);
  EXPECT_FALSE(plain.find(plain.scan_at(test::pose(0.5, 0, 0, 0, 0, 0)), {test::pose(0, 0, 0, 0, 0, 0), 5, 0.2}));
  EXPECT_FALSE(plain.find_globally(plain.scan_at(test::pose(0.5, 0, 0, 0, 0, 0))));
}

TEST(VerifyPlace, RefusesToGuessWhichOfManyHousesItIs) {
  const Remembered houses(terrace(8), -40, 40);
  const Pose T = test::pose(1.7, 0.5, 0, 0, 0, 0.05);
  const auto scan = houses.scan_at(T);
  EXPECT_FALSE(houses.find(scan, {test::pose(4, 0, 0, 0, 0, 0), 7, 0.2}));
  EXPECT_FALSE(houses.find_globally(scan));
  // Known to less than the distance between them, there is but one.
  const auto match = houses.find(scan, {test::pose(2.7, 0, 0, 0, 0, 0), 3, 0.2});
  ASSERT_TRUE(match);
  EXPECT_LT(error(T, *match), 0.1);
}

TEST(VerifyPlace, RefusesAScanFromAnotherPlace) {
  const Remembered street(test::street(), -20, 20), houses(terrace(11), -20, 20);
  for (const double x : {-10.0, 7.0}) {
    const auto from_houses = houses.scan_at(test::pose(x, 0, 0, 0, 0, 0));
    EXPECT_FALSE(street.find(from_houses, {test::pose(x, 0, 0, 0, 0, 0), 10, kPi}));
    EXPECT_FALSE(street.find_globally(from_houses));
    const auto from_street = street.scan_at(test::pose(x, 0, 0, 0, 0, 0));
    EXPECT_FALSE(houses.find(from_street, {test::pose(x, 0, 0, 0, 0, 0), 10, kPi}));
    EXPECT_FALSE(houses.find_globally(from_street));
  }
}

TEST(VerifyPlace, RefusesAPlaceThatIsNotWithinTheGuess) {
  const Remembered street(test::street(), -20, 20);
  EXPECT_FALSE(street.find(street.scan_at(test::pose(12, 0, 0, 0, 0, 0)), {test::pose(-5, 0, 0, 0, 0, 0), 5, 0.2}));
  EXPECT_FALSE(street.find(street.scan_at(test::pose(0, 0, 0, 0, 0, 1.5)), {test::pose(0, 0, 0, 0, 0, 0), 5, 0.2}));
}

TEST(VerifyPlace, SurvivesInputThatIsNone) {
  const Remembered street(test::street(), -10, 10);
  const auto scan = street.scan_at(test::pose(0, 0, 0, 0, 0, 0));
  const PlaceGuess here{test::pose(0, 0, 0, 0, 0, 0), 5, 0.2};
  EXPECT_FALSE(street.find({}, here));
  EXPECT_FALSE(street.find(std::vector<scan::LidarPoint>(500), here)) << "all returns at zero";
  std::vector<scan::LidarPoint> nan(500);
  for (scan::LidarPoint& p : nan) p.position.setConstant(std::numeric_limits<float>::quiet_NaN());
  EXPECT_FALSE(street.find(nan, here));
  EXPECT_FALSE(street.find_globally(nan));
  EXPECT_FALSE(street.find(scan, {test::pose(kNaN, 0, 0, 0, 0, 0), 5, 0.2}));
  EXPECT_FALSE(street.find(scan, {test::pose(0, 0, 0, kNaN, 0, 0), 5, 0.2}));
  EXPECT_FALSE(street.find(scan, {test::pose(0, 0, 0, 0, 0, 0), kNaN, kNaN}));
  EXPECT_FALSE(street.find(scan, {test::pose(1e6, 0, 0, 0, 0, 0), 1e9, 0.2}));
  EXPECT_FALSE(verify_place(scan, here, {}, config::IcpConfig{}, street.lidar));
  EXPECT_FALSE(verify_place(scan, Pose::Identity(), ScanContext{}, {}, config::IcpConfig{}, street.lidar));
  std::vector<scan::LidarPoint> some = scan;
  for (std::size_t i = 0; i < some.size(); i += 7) some[i].position.y() = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(street.find(some, here));
}

TEST(VerifyPlace, FindsRecordedScansOnTheirStreetAndRefusesThoseFromFurtherOn) {
  const std::string folder = test::data_path("kitti0005_rs16");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const bench::mapping::drives::ScanDrive drive(folder, folder + "/reference_poses.txt", folder + "/times.txt");
  const evaluate::truth::Trajectory& truth = drive.truth();
  const auto view = [&](std::size_t i) {
    const double stride = 1e-6 * static_cast<double>(truth[i + 1].utime - truth[i].utime);
    const scan::Twist twist = scan::twist_of(truth[i].pose.inverse() * truth[i + 1].pose, stride);
    const scan::Scan r = drive.scan(i);
    const double sweep = 1e-6 * static_cast<double>(r.end - r.start);
    return std::pair(Pose(truth[i].pose * scan::move(twist, 0.5 * sweep)),
                     scan::deskew(r.points, Pose::Identity(), scan::steady_sweep(twist, sweep)));
  };
  std::vector<scan::Keyframe> nodes;
  for (std::size_t i = 0; i < 60; i += 4) {
    const auto [T, points] = view(i);
    nodes.push_back(node_of(points, T));
  }
  std::vector<const scan::Keyframe*> all;
  for (const scan::Keyframe& node : nodes) all.push_back(&node);
  for (std::size_t i = 6; i < 58; i += 10) {
    const auto [T, points] = view(i);
    PlaceGuess guess{T, 5, 0.35};
    guess.T_map_base.translation() += Eigen::Vector3d(i % 20 == 6 ? 3 : -3, 2.5, 0.5);
    guess.T_map_base.linear() = T.linear() * rotation_from_rpy(0, 0, i % 20 == 6 ? 0.3 : -0.3);
    const auto match = verify_place(points, guess, all, config::IcpConfig{}, Eigen::Vector3d::Zero());
    ASSERT_TRUE(match);
    EXPECT_LT(error(T, *match), 0.05);
  }
  for (std::size_t i = 100; i < 150; i += 10) {
    const auto [T, points] = view(i);
    PlaceGuess guess{truth[30].pose, 10, 0.5};
    EXPECT_FALSE(verify_place(points, guess, all, config::IcpConfig{}, Eigen::Vector3d::Zero()));
  }
}

}  // namespace
}  // namespace curbstone::mapper::place_recognition
