#include "services/tensor_voting/kernels/decomposition.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <limits>
#include <random>

#include "tests/services/tensor_voting/clouds.hpp"

namespace curbstone::tensor_voting::kernels {
namespace {

Tensor tensor_of(const Eigen::Matrix3d& m, double mass = 1) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2), mass};
}

TEST(Decomposition, OfTheIdealShapes) {
  const Decomposition plane = decompose({.xx = 0.5, .yy = 0.5, .zz = 1, .mass = 7});
  EXPECT_DOUBLE_EQ(plane.stick, 0.5);
  EXPECT_DOUBLE_EQ(plane.plate, 0);
  EXPECT_DOUBLE_EQ(plane.ball, 0.5);
  EXPECT_EQ(plane.normal, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(plane.mass, 7);
  const Decomposition line = decompose({.xx = 0, .yy = 1, .zz = 1, .mass = 1});
  EXPECT_DOUBLE_EQ(line.plate, 1);
  EXPECT_EQ(line.tangent, Eigen::Vector3d::UnitX());
  const Decomposition crease = decompose({.xx = 0.5, .yy = 0.75, .zz = 0.75, .mass = 1});
  EXPECT_DOUBLE_EQ(crease.stick, 0);
  EXPECT_DOUBLE_EQ(crease.plate, 0.25 / 0.75);
  EXPECT_EQ(crease.tangent, Eigen::Vector3d::UnitX());
}

TEST(Decomposition, AgreesWithEigenOnRandomTensors) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 2000; ++i) {
    Eigen::Matrix3d b;
    for (int k = 0; k < 9; ++k) b(k / 3, k % 3) = normal(random);
    const Eigen::Matrix3d m = b * b.transpose() * std::pow(10.0, normal(random) * 4);
    const Decomposition d = decompose(tensor_of(m));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m);
    const Eigen::Vector3d l = solver.eigenvalues();
    EXPECT_NEAR(d.stick, (l[2] - l[1]) / l[2], 1e-12);
    EXPECT_NEAR(d.plate, (l[1] - l[0]) / l[2], 1e-12);
    EXPECT_NEAR(d.stick + d.plate + d.ball, 1, 1e-15);
    EXPECT_NEAR((m * d.normal - l[2] * d.normal).norm(), 0, 1e-12 * l[2]);
    EXPECT_NEAR((m * d.tangent - l[0] * d.tangent).norm(), 0, 1e-12 * l[2]);
    EXPECT_NEAR(d.normal.norm(), 1, 1e-15);
    EXPECT_GE(d.normal.z(), 0);
    EXPECT_GE(d.tangent.z(), 0);
  }
}

TEST(Decomposition, SignsFollowTheConvention) {
  const auto normal_of = [](const Eigen::Vector3d& n) { return decompose(tensor_of(n * n.transpose())).normal; };
  for (const Eigen::Vector3d& n : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)}) {
    EXPECT_EQ(normal_of(n), n);
    EXPECT_EQ(normal_of(-n), n);
  }
  EXPECT_GT(normal_of({0.6, -0.8, 0}).y(), 0) << "horizontal: y decides";
}

TEST(Decomposition, OfNothingHasNoShares) {
  for (const Tensor& t : {Tensor{}, tensor_of(Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN())),
                          tensor_of(Eigen::Matrix3d::Constant(std::numeric_limits<double>::infinity()))}) {
    const Decomposition d = decompose(t);
    EXPECT_EQ(d.stick + d.plate + d.ball, 0);
    EXPECT_EQ(d.mass, 0);
    EXPECT_EQ(d.normal, Eigen::Vector3d::UnitZ());
  }
}

TEST(Decomposition, EqualEigenvaluesChooseTheSteeperAxisFirst) {
  const Decomposition d = decompose({.xx = 2, .yy = 2, .zz = 2, .mass = 1});
  EXPECT_EQ(d.normal, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(d.ball, 1);
  const Decomposition e = decompose({.xx = 1, .yy = 1, .zz = 0.25, .mass = 1});
  EXPECT_EQ(e.tangent, Eigen::Vector3d::UnitZ());
}

}  // namespace
}  // namespace curbstone::tensor_voting::kernels
