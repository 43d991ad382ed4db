// Batch voting on a GPU; and the same source run by the host in its place, so that it is tested where there is none.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>

#include "services/tensor_voting/cuda/cloud_request.hpp"
#include "services/tensor_voting/cuda/cuda_voting.hpp"
#include "services/tensor_voting/voting/ball_vote.hpp"
#include "services/tensor_voting/voting/step_cloud.hpp"
#include "tests/services/tensor_voting/clouds.hpp"
#include "tests/services/tensor_voting/cuda/cuda_host_machine.hpp"

namespace curbstone::tensor_voting::cuda {
namespace {

using test_clouds::matrix;
using test_clouds::street;

CudaBatchVoter voter_in_the_devices_place() {
  return CudaBatchVoter([] { return std::make_unique<CloudBatchOn<HostMachine>>(HostMachine{}); });
}

class CudaBatch : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (on_device() && !cuda_available()) GTEST_SKIP() << "not run on a GPU: " << why_no_cuda();
  }
  [[nodiscard]] static bool on_device() { return std::strcmp(GetParam(), "OnTheDevice") == 0; }
  [[nodiscard]] static voting::CloudVotes vote(std::span<const Eigen::Vector3d> points,
                                               const voting::VotingParameters& parameters,
                                               const voting::BatchOptions& options = {}) {
    if (on_device()) return vote_cloud_cuda(points, parameters, options);
    voting::CloudVotes votes;
    voter_in_the_devices_place().vote(points, parameters, options, votes);
    return votes;
  }

  /// On the same whole steps: a pair at the cut-off must not fall on either side of it by chance.
  static void expect_equal_to_brute_force(const std::vector<Eigen::Vector3d>& points,
                                          voting::VotingParameters parameters) {
    parameters.voxel = 0;
    const voting::StepCloud cloud = voting::to_steps(points, parameters.sigma);
    std::vector<Eigen::Vector3d> in_steps;
    for (const voting::WidePoint& p : cloud.points) in_steps.emplace_back(p.x, p.y, p.z);
    voting::VotingParameters scaled = parameters;
    scaled.sigma /= cloud.step;
    scaled.radius /= cloud.step;
    const auto expected = voting::vote_brute_force(in_steps, scaled);
    const voting::CloudVotes votes = vote(points, parameters);
    ASSERT_EQ(votes.tensors.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_LE((test_clouds::matrix(votes.tensors[i]) - test_clouds::matrix(expected[i])).norm(),
                1e-5 * test_clouds::matrix(expected[i]).norm())
          << i;
      EXPECT_NEAR(votes.tensors[i].mass, expected[i].mass, 1e-5 * expected[i].mass);
      const kernels::Decomposition d = kernels::decompose(expected[i]);
      EXPECT_NEAR(votes.decompositions[i].stick, d.stick, 1e-4) << i;
      EXPECT_NEAR(votes.decompositions[i].plate, d.plate, 1e-4) << i;
      EXPECT_NEAR(votes.decompositions[i].ball, d.ball, 1e-4) << i;
      if (d.stick > 0.1) {
        EXPECT_GT(std::abs(votes.decompositions[i].normal.cast<double>().dot(d.normal)), 1 - 1e-6) << i;
      }
    }
  }

  static void expect_equal_to_the_cpu(const std::vector<Eigen::Vector3d>& points,
                                      const voting::VotingParameters& parameters, const voting::BatchOptions& options,
                                      double tolerance) {
    const voting::CloudVotes expected = voting::vote_cloud(points, parameters, 2, options);
    const voting::CloudVotes votes = vote(points, parameters, options);
    EXPECT_EQ(votes.num_voters, expected.num_voters);
    EXPECT_EQ(votes.not_finite, expected.not_finite);
    EXPECT_EQ(votes.too_far, expected.too_far);
    EXPECT_EQ(votes.voxel, expected.voxel);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_LE((test_clouds::matrix(votes.tensors[i]) - test_clouds::matrix(expected.tensors[i])).norm(),
                tolerance * test_clouds::matrix(expected.tensors[i]).norm())
          << i;
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Run, CudaBatch, ::testing::Values("InItsPlace", "OnTheDevice"),
                         [](const auto& run) { return run.param; });

TEST_P(CudaBatch, OfLatticesIsExact) {
  for (const double a : {1.0, 0.5}) {
    const voting::VotingParameters wide{.sigma = 0.3, .radius = 2.4, .ball = a, .voxel = 0};
    const auto expect = [&](const std::vector<Eigen::Vector3d>& points, double w, const Eigen::Vector3d& diagonal) {
      const voting::CloudVotes votes = vote(points, wide);
      const kernels::TensorF& t = votes.tensors[points.size() / 2];
      EXPECT_NEAR(t.mass, w, 1e-5 * w);
      EXPECT_LE((test_clouds::matrix(t) - w * diagonal.asDiagonal().toDenseMatrix()).norm(), 1e-5 * w);
    };
    const double sigmas = std::sqrt(std::numbers::pi) * 0.3 / 0.1;
    std::vector<Eigen::Vector3d> line;
    std::vector<Eigen::Vector3d> plane;
    std::vector<Eigen::Vector3d> volume;
    for (int x = -24; x <= 24; ++x) {
      line.emplace_back(0.1 * x, 0, 0);
      for (int y = -24; y <= 24; ++y) plane.emplace_back(0.1 * x, 0.1 * y, 0);
    }
    for (int x = -7; x <= 7; ++x) {  // out to 3.75 sigma: 3e-7 of the mass is beyond
      for (int y = -7; y <= 7; ++y) {
        for (int z = -7; z <= 7; ++z) volume.emplace_back(0.15 * x, 0.15 * y, 0.15 * z);
      }
    }
    expect(line, sigmas - 1, {1 - a, 1, 1});
    expect(plane, sigmas * sigmas - 1, {1 - a / 2, 1 - a / 2, 1});
    expect(volume, std::pow(sigmas / 1.5, 3) - 1, Eigen::Vector3d::Constant(1 - a / 3));
  }
}

TEST_P(CudaBatch, EqualsBruteForceOnStreetRandomAndDegenerateClouds) {
  expect_equal_to_brute_force(test_clouds::street(3'000, 1), {});
  expect_equal_to_brute_force(test_clouds::street(3'000, 2), {.sigma = 0.1, .radius = 0.3, .ball = 0.5});
  expect_equal_to_brute_force(test_clouds::street(1'000, 2), {.sigma = 0.3, .radius = 0.1});
  expect_equal_to_brute_force(test_clouds::street(1'000, 3), {.sigma = 0.5, .radius = 3});
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Eigen::Vector3d> cube(2000);
  for (auto& p : cube) p = {unit(random), unit(random), unit(random)};
  expect_equal_to_brute_force(cube, {});
  std::vector<Eigen::Vector3d> line;
  for (int i = 0; i < 500; ++i) line.emplace_back(unit(random), 0, 0);
  expect_equal_to_brute_force(line, {});
  std::vector<Eigen::Vector3d> wall;
  for (int i = 0; i < 700; ++i) wall.emplace_back(0, unit(random), 3 * unit(random));
  expect_equal_to_brute_force(wall, {});
  std::vector<Eigen::Vector3d> sparse;
  for (int i = 0; i < 300; ++i) sparse.emplace_back(0.7 * i, 1e3 * unit(random), 0);
  sparse.insert(sparse.end(), line.begin(), line.end());
  expect_equal_to_brute_force(sparse, {});
  expect_equal_to_brute_force({{0, 0, 0}}, {});
  expect_equal_to_brute_force({{0, 0, 0}, {0, 0, 0}, {0.1, 0, 0}}, {});
  expect_equal_to_brute_force(std::vector<Eigen::Vector3d>(100, {3, 4, 5}), {});
}

TEST_P(CudaBatch, ARadiusBeyondAllDecayChangesNothing) {
  const auto points = test_clouds::street(500, 3);
  const voting::CloudVotes far = vote(points, {.sigma = 0.2, .radius = 1e9});
  const voting::CloudVotes near = vote(points, {.sigma = 0.2, .radius = 12 * 0.2});
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_EQ(test_clouds::matrix(far.tensors[i]), test_clouds::matrix(near.tensors[i]));
}

TEST_P(CudaBatch, EqualsTheCpuThinnedOutToo) {
  for (const double voxel : {0.0, 0.05, 0.1, 0.3})
    expect_equal_to_the_cpu(test_clouds::street(6'000, 5), {.voxel = voxel}, {}, 1e-5);
  std::vector<Eigen::Vector3d> lattice;  // points on the faces of voxels
  for (int x = -20; x <= 20; ++x) {
    for (int y = -20; y <= 20; ++y) lattice.emplace_back(0.05 * x, 0.05 * y, 0.1);
  }
  expect_equal_to_the_cpu(lattice, {.voxel = 0.1}, {}, 1e-5);
}

TEST_P(CudaBatch, EqualsTheCpuInASecondPassAndWithDensityEqualised) {
  const auto points = test_clouds::street(3'000, 6);
  expect_equal_to_the_cpu(points, {.voxel = 0}, {.second_pass = true}, 1e-4);
  expect_equal_to_the_cpu(points, {.voxel = 0}, {.equalise_density = true}, 1e-5);
  expect_equal_to_the_cpu(points, {.radius = 0.1, .voxel = 0}, {.equalise_density = true}, 1e-5);
  expect_equal_to_the_cpu(points, {.ball = 0.5, .voxel = 0.05}, {.second_pass = true, .equalise_density = true}, 1e-4);
}

TEST_P(CudaBatch, KeepsItsMemoryAndNothingElse) {
  CudaBatchVoter voter = on_device() ? CudaBatchVoter() : voter_in_the_devices_place();
  voting::CloudVotes votes;
  for (const std::size_t size : {4'000U, 500U, 0U, 2'000U}) {
    const std::vector<Eigen::Vector3d> cloud = size > 0 ? street(size, 1) : std::vector<Eigen::Vector3d>();
    for (const bool second_pass : {true, false}) {
      const voting::VotingParameters parameters{.voxel = second_pass ? 0.1 : 0.0};
      voter.vote(cloud, parameters, {.second_pass = second_pass}, votes);
      const voting::CloudVotes alone = vote(cloud, parameters, {.second_pass = second_pass});
      ASSERT_EQ(votes.tensors.size(), cloud.size());
      ASSERT_EQ(votes.decompositions.size(), cloud.size());
      EXPECT_EQ(votes.num_voters, alone.num_voters);
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        EXPECT_EQ(matrix(votes.tensors[i]), matrix(alone.tensors[i]));
        EXPECT_EQ(votes.decompositions[i].normal, alone.decompositions[i].normal);
      }
    }
  }
}

TEST_P(CudaBatch, OfNothingIsNothing) {
  EXPECT_TRUE(vote({}, {}).tensors.empty());
  EXPECT_THROW((void)vote({}, {.sigma = 0}), std::invalid_argument);
  EXPECT_THROW((void)vote({}, {.radius = 0}), std::invalid_argument);
}

TEST_P(CudaBatch, SkipsAndCountsWhatIsNoPoint) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const double voxel : {0.0, 0.1}) {
    const std::vector<Eigen::Vector3d> points{{0, 0, 0},    {kNaN, 0, 0},  {0.12, 0, 0},
                                              {0, kInf, 0}, {0, 0, 1e300}, {0, -1e300, kNaN}};
    const voting::CloudVotes votes = vote(points, {.voxel = voxel});
    EXPECT_EQ(votes.not_finite, 3U);
    EXPECT_EQ(votes.too_far, 1U);
    EXPECT_EQ(votes.num_voters, 2U);
    EXPECT_GT(votes.tensors[0].mass, 0.8);
    EXPECT_EQ(votes.tensors[0].mass, votes.tensors[2].mass);
    for (const std::size_t i : {1U, 3U, 4U, 5U}) EXPECT_EQ(votes.tensors[i].mass, 0);
  }
  const std::vector<Eigen::Vector3d> none(3, {kNaN, 0, 0});
  EXPECT_EQ(vote(none, {}).not_finite, 3U);
}

TEST_P(CudaBatch, AtAMillionMetresLosesNothing) {
  const auto near = test_clouds::street(2'000, 3);
  std::vector<Eigen::Vector3d> far;
  for (const auto& p : near) far.emplace_back(p + Eigen::Vector3d(1e6, -1e6, 1e3));
  expect_equal_to_brute_force(far, {});
}

TEST_P(CudaBatch, TurnsWithTheCloud) {
  const auto points = test_clouds::street(2'000, 4);
  const Eigen::Matrix3d Q = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 1).normalized()).toRotationMatrix();
  std::vector<Eigen::Vector3d> turned;
  for (const auto& p : points) turned.emplace_back(Q * p);
  const voting::CloudVotes a = vote(points, {.voxel = 0});
  const voting::CloudVotes b = vote(turned, {.voxel = 0});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Matrix3d expected = Q * test_clouds::matrix(a.tensors[i]) * Q.transpose();
    EXPECT_LE((test_clouds::matrix(b.tensors[i]) - expected).norm(), 1e-4 * expected.norm() + 3e-4);
  }
}

TEST_P(CudaBatch, ThinsOutAHeapUnaskedAndSaysSo) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-0.3, 0.3);
  std::vector<Eigen::Vector3d> heap(120'000);
  for (auto& p : heap) p = {unit(random), unit(random), unit(random)};
  const voting::CloudVotes votes = vote(heap, {.voxel = 0});
  EXPECT_EQ(votes.voxel, 0.3 / 8);
  EXPECT_LE(votes.num_voters, 18U * 18 * 18);
  EXPECT_GT(votes.tensors[0].mass, 10);
}

TEST_P(CudaBatch, TellsWhereItsTimeGoes) {
  if (!on_device()) {
    EXPECT_FALSE(time_cuda_voting({}, {}).has_value());
    return;
  }
  const auto timings = time_cuda_voting(test_clouds::street(50'000, 1), {.voxel = 0}, 3);
  ASSERT_TRUE(timings.has_value());
  EXPECT_GT(timings->pairs_tested, timings->pair_votes);
  EXPECT_GT(timings->vote_ms, timings->flops_floor_ms) << "no device is faster than its peak";
  EXPECT_GE(timings->total_ms, timings->vote_ms);
}

TEST(CudaVoting, WithoutADeviceSaysWhy) {
  if (cuda_available()) GTEST_SKIP() << "there is a GPU";
  const std::vector<Eigen::Vector3d> points{{0, 0, 0}};
  EXPECT_FALSE(why_no_cuda().empty());
  EXPECT_FALSE(time_cuda_voting(points, {}).has_value());
  EXPECT_THROW((void)vote_cloud_cuda(points, {}), std::runtime_error);
}

}  // namespace
}  // namespace curbstone::tensor_voting::cuda
