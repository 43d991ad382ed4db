#include "common/linear/decompositions.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <limits>

namespace curbstone {

namespace {

SmallMatrix solution(const Eigen::LDLT<SmallMatrix>& ldlt, const SmallMatrix& b) {
  return ldlt.solve(b);
}

}  // namespace

template <int N>
Ldlt<N>::Ldlt(const SquareMatrix<N>& A) : ldlt_(A) {}

template <int N>
ColumnVector<N> Ldlt<N>::solve(const ColumnVector<N>& b) const {
  return solution(ldlt_, b);
}

template <int N>
SquareMatrix<N> Ldlt<N>::inverse() const {
  return solution(ldlt_, SmallMatrix::Identity(N, N));
}

template <int N>
double Ldlt<N>::least_pivot() const {
  return ldlt_.info() == Eigen::Success ? ldlt_.vectorD().minCoeff() : 0.0;
}

SmallMatrix inverse_of_symmetric(const SmallMatrix& A) {
  return solution(Eigen::LDLT<SmallMatrix>(A), SmallMatrix::Identity(A.rows(), A.rows()));
}

template <int N>
std::optional<SquareMatrix<N>> cholesky_root(const SquareMatrix<N>& A) {
  const Eigen::LLT<SmallMatrix> llt(A);
  const SmallMatrix root = llt.matrixU();
  if (llt.info() != Eigen::Success || !root.allFinite()) return std::nullopt;
  return SquareMatrix<N>(root);
}

template <int N>
EigenPairs<N> eigen_pairs(const SquareMatrix<N>& A) {
  const Eigen::SelfAdjointEigenSolver<SmallMatrix> solver(A);
  if (solver.info() != Eigen::Success) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {ColumnVector<N>::Constant(kNone), SquareMatrix<N>::Constant(kNone)};
  }
  return {solver.eigenvalues(), solver.eigenvectors()};
}

EigenPairs<3> eigen_pairs_direct(const Eigen::Matrix3d& A) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SquareMatrix<6> inverse(const SquareMatrix<6>& A) {
  return SmallMatrix(A).inverse();
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& C) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(C, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
  mirror(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1.0 : 1.0;
  return svd.matrixU() * mirror * svd.matrixV().transpose();
}

template class Ldlt<2>;
template class Ldlt<3>;
template class Ldlt<4>;
template class Ldlt<6>;
template std::optional<SquareMatrix<6>> cholesky_root(const SquareMatrix<6>& A);
template EigenPairs<2> eigen_pairs(const SquareMatrix<2>& A);
template EigenPairs<3> eigen_pairs(const SquareMatrix<3>& A);
template EigenPairs<6> eigen_pairs(const SquareMatrix<6>& A);

}  // namespace curbstone
