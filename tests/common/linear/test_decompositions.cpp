#include "common/linear/decompositions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "common/geometry/geometry.hpp"

namespace curbstone {
namespace {

template <int N>
SquareMatrix<N> any_matrix(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return SquareMatrix<N>::NullaryExpr([&] { return normal(random); });
}

template <int N>
SquareMatrix<N> any_positive_definite(std::mt19937& random) {
  const SquareMatrix<N> A = any_matrix<N>(random);
  return A * A.transpose() + 0.1 * SquareMatrix<N>::Identity();
}

template <int N>
void expect_solved() {
  std::mt19937 random(7);
  for (int i = 0; i < 20; ++i) {
    const SquareMatrix<N> A = any_positive_definite<N>(random);
    const ColumnVector<N> b = any_matrix<N>(random).col(0);
    const Ldlt<N> ldlt(A);
    EXPECT_LT((A * ldlt.solve(b) - b).norm(), 1e-10 * b.norm());
    EXPECT_LT((A * ldlt.inverse() - SquareMatrix<N>::Identity()).norm(), 1e-9);
    EXPECT_GT(ldlt.least_pivot(), 0.0);
  }
}

TEST(Ldlt, SolvesAndInvertsAtEverySize) {
  expect_solved<2>();
  expect_solved<3>();
  expect_solved<4>();
  expect_solved<6>();
}

TEST(InverseOfSymmetric, IsThatOfAnySizeAndReadsTheLowerTriangleOnly) {
  std::mt19937 random(7);
  for (int rows = 1; rows <= kMaxRows; ++rows) {
    const SmallMatrix A = any_positive_definite<kMaxRows>(random).topLeftCorner(rows, rows);
    const SmallMatrix one = A * inverse_of_symmetric(A);
    EXPECT_LT((one - SmallMatrix::Identity(rows, rows)).norm(), 1e-9);
    EXPECT_EQ(inverse_of_symmetric(A.triangularView<Eigen::Lower>()), inverse_of_symmetric(A));
  }
}

TEST(Ldlt, ReadsTheLowerTriangleOnly) {
  Eigen::Matrix2d A;
  A << 4, -99, 1, 3;
  const Eigen::Vector2d x = Ldlt<2>(A).solve({1, 2});
  EXPECT_NEAR(x[0], 1.0 / 11, 1e-15);
  EXPECT_NEAR(x[1], 7.0 / 11, 1e-15);
}

TEST(Ldlt, HasNoPivotAboveZeroWhereTheMatrixIsNotPositiveDefinite) {
  EXPECT_LE(Ldlt<3>(Eigen::Vector3d(1, 2, 0).asDiagonal()).least_pivot(), 0.0);
  EXPECT_LE(Ldlt<3>(Eigen::Vector3d(1, -2, 3).asDiagonal()).least_pivot(), 0.0);
}

TEST(Ldlt, SaysThatWhatIsNotANumberHasNoSolution) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Ldlt<3> ldlt(Eigen::Matrix3d::Constant(nan));
  EXPECT_FALSE(ldlt.solve({1, 1, 1}).allFinite());
  EXPECT_FALSE(ldlt.least_pivot() > 0.0);
}

TEST(CholeskyRoot, SquaredIsTheMatrix) {
  std::mt19937 random(3);
  const SquareMatrix<6> A = any_positive_definite<6>(random);
  const auto U = cholesky_root<6>(A);
  ASSERT_TRUE(U);
  EXPECT_LT((U->transpose() * *U - A).norm(), 1e-12 * A.norm());
  EXPECT_EQ(U->triangularView<Eigen::StrictlyLower>().toDenseMatrix(), SquareMatrix<6>::Zero());
}

TEST(CholeskyRoot, IsNoneOfWhatIsNotPositiveDefinite) {
  EXPECT_FALSE(cholesky_root<6>(-SquareMatrix<6>::Identity()));
  EXPECT_FALSE(cholesky_root<6>(SquareMatrix<6>::Constant(std::numeric_limits<double>::quiet_NaN())));
}

template <int N>
void expect_pairs(const EigenPairs<N>& pairs, const SquareMatrix<N>& A) {
  EXPECT_LT((A * pairs.vectors - pairs.vectors * pairs.values.asDiagonal()).norm(), 1e-9 * A.norm());
  EXPECT_LT((pairs.vectors.transpose() * pairs.vectors - SquareMatrix<N>::Identity()).norm(), 1e-9);
  for (int i = 1; i < N; ++i) EXPECT_LE(pairs.values[i - 1], pairs.values[i]);
}

TEST(EigenPairs, AreOrderedAndOfLengthOneAtEverySize) {
  std::mt19937 random(5);
  for (int i = 0; i < 20; ++i) {
    const SquareMatrix<2> A = any_positive_definite<2>(random);
    const SquareMatrix<3> B = any_positive_definite<3>(random);
    const SquareMatrix<6> C = any_positive_definite<6>(random);
    expect_pairs<2>(eigen_pairs<2>(A), A);
    expect_pairs<3>(eigen_pairs<3>(B), B);
    expect_pairs<6>(eigen_pairs<6>(C), C);
    expect_pairs<3>(eigen_pairs_direct(B), B);
  }
}

TEST(EigenPairs, OfWhatIsNotANumberAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(eigen_pairs<6>(SquareMatrix<6>::Constant(nan)).values[0] >= 0.0);
}

TEST(Inverse, TimesTheMatrixIsOne) {
  std::mt19937 random(9);
  for (int i = 0; i < 20; ++i) {
    const SquareMatrix<6> A = any_matrix<6>(random);
    EXPECT_LT((A * inverse(A) - SquareMatrix<6>::Identity()).norm(), 1e-9);
  }
}

TEST(Inverse, IsNotFiniteWhereThereIsNone) {
  EXPECT_FALSE(inverse(SquareMatrix<6>::Zero()).allFinite());
}

TEST(NearestRotation, IsTheOneThatTurnsTheCloud) {
  std::mt19937 random(2);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Matrix3d R = so3_exp(any_matrix<3>(random).col(0)).toRotationMatrix();
    const Eigen::Matrix3d spread = any_positive_definite<3>(random);
    EXPECT_LT((nearest_rotation(R * spread) - R).norm(), 1e-9);
  }
}

TEST(NearestRotation, NeverMirrors) {
  const Eigen::Matrix3d R = nearest_rotation(Eigen::Vector3d(3, 2, -1).asDiagonal());
  EXPECT_NEAR(R.determinant(), 1.0, 1e-12);
  EXPECT_LT((R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

}  // namespace
}  // namespace curbstone
