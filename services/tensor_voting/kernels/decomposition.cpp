#include "services/tensor_voting/kernels/decomposition.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "services/tensor_voting/kernels/tensor_block.hpp"

namespace curbstone::tensor_voting::kernels {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

/// One Jacobi rotation in the plane of axes p and q: it zeroes element (p, q) of `a` and rotates the columns of `v`. An
/// element up to `nothing` counts as zero.
inline void rotate(Matrix& a, Matrix& v, std::size_t p, std::size_t q, double nothing) {
  if (std::abs(a[p][q]) <= nothing) return;
  // t = tan of the angle that zeroes a[p][q], the smaller root of t^2 + 2 t theta - 1 = 0 (Golub & Van Loan, 8.5.2).
  const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const double t = (theta >= 0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
  const double c = 1 / std::sqrt(t * t + 1);
  const double s = t * c;
  const std::size_t r = 3 - p - q;
  a[p][p] -= t * a[p][q];
  a[q][q] += t * a[p][q];
  a[p][q] = a[q][p] = 0;
  const double rp = a[r][p];
  const double rq = a[r][q];
  a[r][p] = a[p][r] = c * rp - s * rq;
  a[r][q] = a[q][r] = s * rp + c * rq;
  for (auto& row : v) {
    const double vp = row[p];
    const double vq = row[q];
    row[p] = c * vp - s * vq;
    row[q] = s * vp + c * vq;
  }
}

/// Diagonalises `a`; the columns of the result are the eigenvectors.
Matrix diagonalise(Matrix& a) {
  Matrix v{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const double scale = std::abs(a[0][0]) + std::abs(a[1][1]) + std::abs(a[2][2]);
  for (int sweep = 0; sweep < 8; ++sweep) {  // quadratic convergence: three or four sweeps
    if (std::abs(a[0][1]) + std::abs(a[0][2]) + std::abs(a[1][2]) <= 1e-15 * scale) break;
    rotate(a, v, 0, 1, 1e-16 * scale);
    rotate(a, v, 0, 2, 1e-16 * scale);
    rotate(a, v, 1, 2, 1e-16 * scale);
  }
  return v;
}

Eigen::Vector3d upper(const Matrix& v, std::size_t column) {
  Eigen::Vector3d e(v[0][column], v[1][column], v[2][column]);
  e /= std::sqrt(e.x() * e.x() + e.y() * e.y() + e.z() * e.z());
  const bool down = e.z() < 0 || (e.z() == 0 && (e.y() < 0 || (e.y() == 0 && e.x() < 0)));
  return down ? Eigen::Vector3d(-e) : e;
}

}  // namespace

Decomposition decompose(const Tensor& t) {
  Decomposition result;
  const double trace = t.xx + t.yy + t.zz;
  if (!std::isfinite(trace + t.xy + t.xz + t.yz) || !(trace > 0)) return result;
  Matrix a{{{t.xx, t.xy, t.xz}, {t.xy, t.yy, t.yz}, {t.xz, t.yz, t.zz}}};
  const Matrix v = diagonalise(a);

  std::array<std::size_t, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    if (a[i][i] != a[j][j]) return a[i][i] > a[j][j];
    const double steep_i = std::abs(v[2][i]);
    const double steep_j = std::abs(v[2][j]);
    return steep_i != steep_j ? steep_i > steep_j : i < j;
  });
  const auto lambda = [&](std::size_t i) { return std::max(0.0, a[order[i]][order[i]]); };
  result.normal = upper(v, order[0]);
  result.tangent = upper(v, order[2]);
  result.stick = (lambda(0) - lambda(1)) / lambda(0);
  result.plate = (lambda(1) - lambda(2)) / lambda(0);
  result.ball = lambda(2) / lambda(0);
  result.mass = t.mass;
  return result;
}

std::vector<DecompositionF> decompose(std::span<const TensorF> tensors) {
  std::vector<TensorBlock> blocks((tensors.size() + kLanes - 1) / kLanes);
  for (std::size_t i = 0; i < tensors.size(); ++i) blocks[i / kLanes].set(i % kLanes, tensors[i]);
  std::vector<ShapeBlock> shapes(blocks.size());
  decompose(blocks, shapes);
  std::vector<DecompositionF> results(tensors.size());
  for (std::size_t i = 0; i < tensors.size(); ++i) {
    results[i] = shapes[i / kLanes].get(i % kLanes, tensors[i].mass);
  }
  return results;
}

}  // namespace curbstone::tensor_voting::kernels
