#include "services/localizer/monte_carlo/particle_filter.hpp"

#include <gtest/gtest.h>

#include "tests/services/localizer/yard.hpp"

namespace curbstone::localizer::monte_carlo {
namespace {

using test_yard::map_of;
using test_yard::points_in;
using test_yard::pose_at;
using test_yard::Yard;

tracking::PoseBelief start(const Pose& pose, double sigma = 0.3) {
  tracking::Vector6 sigmas;
  sigmas << sigma, sigma, 0.1, 0.02, 0.02, 0.05;
  return {pose, sigmas.cwiseAbs2().asDiagonal()};
}

tracking::Motion ahead(double step) {
  tracking::Motion motion;
  motion.T_last_base.translation().x() = step;
  motion.seconds = 0.05;
  return motion;
}

double error_of(const Pose& truth, const ParticleFilter& filter) {
  return tracking::error_between(truth, filter.belief().T_map_base).head<2>().norm();
}

TEST(ParticleFilter, FollowsADrive) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  Pose truth = pose_at(-4, 0, 0.2), wrong = pose_at(-4.3, 0.2, 0.25);
  ParticleFilter filter(start(wrong), {}, {});
  for (int i = 0; i < 60; ++i) {
    truth = truth * ahead(0.12).T_last_base;
    filter.track({points_in(yard, truth)}, ahead(0.12), map);
  }
  EXPECT_LT(error_of(truth, filter), 0.15);
}

TEST(ParticleFilter, TakesFewerParticlesOnceItKnowsThePlace) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  Pose truth = pose_at(-4, 0, 0.2);
  ParticleFilter filter(start(truth, 1.0), {.particles = 5000, .min_particles = 100}, {});
  EXPECT_EQ(filter.num_particles(), 5000U);
  for (int i = 0; i < 60; ++i) {
    truth = truth * ahead(0.12).T_last_base;
    filter.track({points_in(yard, truth)}, ahead(0.12), map);
  }
  EXPECT_LT(filter.num_particles(), 1000U);
}

TEST(ParticleFilter, DoesNotDriftWhileItStands) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  const Pose truth = pose_at(-4, 0, 0.2);
  ParticleFilter filter(start(truth), {}, {});
  filter.track({points_in(yard, truth)}, ahead(0), map);
  const Pose before = filter.belief().T_map_base;
  for (int i = 0; i < 200; ++i) filter.track({points_in(yard, truth)}, ahead(0), map);
  EXPECT_EQ(filter.belief().T_map_base.translation(), before.translation());
}

TEST(ParticleFilter, SaysTheSameForTheSameSeedAndAnotherForAnother) {
  const Yard yard;
  const auto after = [&](int seed) {
    fields::SavedMap map(map_of(yard));
    Pose truth = pose_at(-4, 0, 0.2);
    ParticleFilter filter(start(truth), {.particles = 500, .seed = seed}, {});
    for (int i = 0; i < 20; ++i) {
      truth = truth * ahead(0.12).T_last_base;
      filter.track({points_in(yard, truth)}, ahead(0.12), map);
    }
    return Eigen::Vector3d(filter.belief().T_map_base.translation());
  };
  EXPECT_EQ(after(1), after(1));
  EXPECT_NE(after(1), after(2));
}

}  // namespace
}  // namespace curbstone::localizer::monte_carlo
