#pragma once

#include <Eigen/Cholesky>
#include <optional>

/// @file
/// Decompositions of small matrices: Eigen's, compiled once and for all sizes alike, for each of their templates costs
/// the file that uses it seconds to compile. A size that is not listed at the end does not link: add it there and in
/// the .cpp.
///
/// Pure; any thread; no memory is allocated. What is not finite gives what is not finite.

namespace curbstone {

/// Of up to six rows, what all sizes are decomposed as.
constexpr int kMostRows = 6;
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostRows, kMostRows>;

template <int N>
using SquareMatrix = Eigen::Matrix<double, N, N>;
template <int N>
using ColumnVector = Eigen::Matrix<double, N, 1>;

/// A symmetric, positive semi-definite A as L D L^T, by which A x = b is solved. Only its lower triangle is read.
template <int N>
class Ldlt {
 public:
  explicit Ldlt(const SquareMatrix<N>& A);
  [[nodiscard]] ColumnVector<N> solve(const ColumnVector<N>& b) const;
  [[nodiscard]] SquareMatrix<N> inverse() const;
  /// The least of D: not above 0 where A is not positive definite.
  [[nodiscard]] double least_pivot() const;

 private:
  Eigen::LDLT<SmallMatrix> ldlt_;
};

/// The upper U with U^T U = A of a symmetric A; nothing where A is not positive definite.
template <int N>
[[nodiscard]] std::optional<SquareMatrix<N>> cholesky_root(const SquareMatrix<N>& A);

/// The eigenvalues of a symmetric matrix in ascending order, and in the columns eigenvectors of length 1 in that order.
template <int N>
struct EigenPairs {
  ColumnVector<N> values;
  SquareMatrix<N> vectors;
};
/// By QR steps on the tridiagonal form; only the lower triangle is read. Not a number where they do not converge.
template <int N>
[[nodiscard]] EigenPairs<N> eigen_pairs(const SquareMatrix<N>& A);
/// In closed form: quicker, and less exact where eigenvalues are alike.
[[nodiscard]] EigenPairs<3> eigen_pairs_direct(const Eigen::Matrix3d& A);

/// The inverse of any matrix, by LU with pivots; not finite where there is none.
[[nodiscard]] SquareMatrix<6> inverse(const SquareMatrix<6>& A);

/// The rotation R with the largest trace(R^T C): of two clouds with covariance C the one that turns the second onto the
/// first (Umeyama 1991, eq. 39-43, without scale).
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
