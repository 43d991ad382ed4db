#pragma once

#include <Eigen/Cholesky>
#include <optional>

/// @file
/// Decompositions of small matrices by Eigen. All sizes are compiled once, here, because each of Eigen's templates adds
/// seconds to the compile time of every file that uses it. A size that is not listed at the end does not link: add it
/// there and in the .cpp.
///
/// Pure; any thread; allocates no memory. Input that is not finite gives a result that is not finite.

namespace curbstone {

/// All sizes up to six rows are decomposed as matrices of this size.
constexpr int kMaxRows = 6;
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxRows, kMaxRows>;

template <int N>
using SquareMatrix = Eigen::Matrix<double, N, N>;
template <int N>
using ColumnVector = Eigen::Matrix<double, N, 1>;

/// A symmetric, positive semi-definite A as L D L^T, which solves A x = b. Only the lower triangle of A is read.
template <int N>
class Ldlt {
 public:
  explicit Ldlt(const SquareMatrix<N>& A);
  [[nodiscard]] ColumnVector<N> solve(const ColumnVector<N>& b) const;
  [[nodiscard]] SquareMatrix<N> inverse() const;
  /// The smallest element of D: <= 0 if A is not positive definite.
  [[nodiscard]] double least_pivot() const;

 private:
  Eigen::LDLT<SmallMatrix> ldlt_;
};

/// The inverse of a symmetric, positive semi-definite matrix of any size up to kMaxRows, by L D L^T; zero in the
/// directions in which the matrix is zero. Only the lower triangle is read.
[[nodiscard]] SmallMatrix inverse_of_symmetric(const SmallMatrix& A);

/// The upper U with U^T U = A of a symmetric A; nothing where A is not positive definite.
template <int N>
[[nodiscard]] std::optional<SquareMatrix<N>> cholesky_root(const SquareMatrix<N>& A);

/// The eigenvalues of a symmetric matrix in ascending order, and the unit eigenvectors as columns in the same order.
template <int N>
struct EigenPairs {
  ColumnVector<N> values;
  SquareMatrix<N> vectors;
};
/// Computes them by QR steps on the tridiagonal form; only the lower triangle is read. NaN if the steps do not
/// converge.
template <int N>
[[nodiscard]] EigenPairs<N> eigen_pairs(const SquareMatrix<N>& A);
/// Computes them in closed form: faster, and less accurate where eigenvalues are similar.
[[nodiscard]] EigenPairs<3> eigen_pairs_direct(const Eigen::Matrix3d& A);

/// The inverse of any matrix, by LU with pivoting; not finite if the matrix is singular.
[[nodiscard]] SquareMatrix<6> inverse(const SquareMatrix<6>& A);

/// The rotation R with the largest trace(R^T C). If C is the cross-covariance of two clouds, R turns the second cloud
/// onto the first (Umeyama 1991, eq. 39-43, without scale).
[[nodiscard]] Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& C);

extern template class Ldlt<2>;
extern template class Ldlt<3>;
extern template class Ldlt<4>;
extern template class Ldlt<6>;
extern template std::optional<SquareMatrix<6>> cholesky_root(const SquareMatrix<6>& A);
extern template EigenPairs<2> eigen_pairs(const SquareMatrix<2>& A);
extern template EigenPairs<3> eigen_pairs(const SquareMatrix<3>& A);
extern template EigenPairs<6> eigen_pairs(const SquareMatrix<6>& A);

}  // namespace curbstone
