#include "services/semantic_map/ground/robust_plane.hpp"

#include <cstddef>
#include <vector>

#include "common/linear/decompositions.hpp"
#include "services/semantic_map/tile/vectorised.hpp"

namespace curbstone::semantic_map::ground {

namespace {

/// Samples by columns, with their weights in the fit of a plane.
class Columns {
 public:
  explicit Columns(const std::vector<PlaneSample>& samples) : n_(samples.size()), memory_(5 * n_) {
    for (std::size_t i = 0; i < n_; ++i) {
      x()[i] = samples[i].x;
      y()[i] = samples[i].y;
      z()[i] = samples[i].z;
      weight()[i] = samples[i].weight;
    }
  }
  double* x() { return memory_.data(); }
  double* y() { return memory_.data() + n_; }
  double* z() { return memory_.data() + 2 * n_; }
  double* weight() { return memory_.data() + 3 * n_; }  ///< PlaneSample::weight
  double* fitted() { return memory_.data() + 4 * n_; }  ///< weight in the present iteration

 private:
  std::size_t n_;
  std::vector<double> memory_;
};

/// The Cauchy weight of each sample, by its residual from a plane.
CURBSTONE_VECTORISED
void weigh(const double* x, const double* y, const double* z, const double* weight, std::size_t n, const Plane& plane,
           double scale_above, double scale_below, double* __restrict fitted) {
  const double height = plane.height;
  const double slope_x = plane.slope.x();
  const double slope_y = plane.slope.y();
  for (std::size_t i = 0; i < n; ++i) {
    const double residual = z[i] - (height + slope_x * x[i] + slope_y * y[i]);
    const double scaled = residual / (residual > 0 ? scale_above : scale_below);
    fitted[i] = weight[i] / (1 + scaled * scaled);
  }
}

using Four = double __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double))));

/// Sums of weighted least squares over rows (1, x, y): w, wx, wy, wz, and their products with x and y.
struct PlaneEquations {
  Four w_wx_wy_wz{};
  Four wxx_wyx_wzx{};
  Four wyy_wzy{};
};

/// Adds the samples in their order, each to several sums in one vector instruction.
CURBSTONE_VECTORISED
void sum_up(const double* x, const double* y, const double* z, const double* fitted, std::size_t n,
            PlaneEquations& sum) {
  Four first{};
  Four second{};
  Four third{};
  for (std::size_t i = 0; i < n; ++i) {
    const Four row = fitted[i] * Four{1, x[i], y[i], z[i]};
    first += row;
    second += __builtin_shufflevector(row, row, 1, 2, 3, 3) * x[i];
    third += __builtin_shufflevector(row, row, 2, 3, 3, 3) * y[i];
  }
  sum = {first, second, third};
}

}  // namespace

Plane fit_plane(const std::vector<PlaneSample>& samples, const Plane& prior, const PlaneFit& fit) {
  Plane plane = prior;
  const double stiffness = (fit.sample_sigma / fit.slope_sigma) * (fit.sample_sigma / fit.slope_sigma);
  Columns columns(samples);
  for (int i = 0; i < fit.iterations; ++i) {
    weigh(columns.x(), columns.y(), columns.z(), columns.weight(), samples.size(), plane, fit.scale_above,
          fit.scale_below, columns.fitted());
    PlaneEquations sum;
    sum_up(columns.x(), columns.y(), columns.z(), columns.fitted(), samples.size(), sum);
    const Four& by_one = sum.w_wx_wy_wz;
    const Four& by_x = sum.wxx_wyx_wzx;
    const Four& by_y = sum.wyy_wzy;
    Eigen::Matrix3d A;
    A << by_one[0] + 1e-9, by_one[1], by_one[2], by_one[1], by_x[0] + stiffness, by_x[1], by_one[2], by_x[1],
        by_y[0] + stiffness;
    const Eigen::Vector3d b(by_one[3] + 1e-9 * plane.height, by_x[2] + stiffness * prior.slope(0),
                            by_y[1] + stiffness * prior.slope(1));
    const Eigen::Vector3d solution = Ldlt<3>(A).solve(b);
    plane = {solution(0), solution.tail<2>()};
  }
  return plane;
}

}  // namespace curbstone::semantic_map::ground
