#include "services/mapper/registration/loam_solver.hpp"

#include <ceres/tiny_solver.h>

#include <cmath>

#include "common/linear/decompositions.hpp"

namespace curbstone::mapper::registration {
namespace {

/// The adjoint of a small twist: translation, then rotation.
Matrix6 small_adjoint(const Vector6& x) {
  Matrix6 out = Matrix6::Zero();
  out.topLeftCorner<3, 3>() = out.bottomRightCorner<3, 3>() = skew(x.tail<3>());
  out.topRightCorner<3, 3>() = skew(x.head<3>());
  return out;
}

/// Residuals whose squares add up to the robust cost: the distance from a plane, the distances from a line along two
/// directions across it, and six for the prior. A loss rho of the distance s becomes a factor sqrt(rho(s^2)) / s.
class LoamResiduals {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = 6 };

  explicit LoamResiduals(const LoamProblem& problem)
      : problem_(problem),
        seen_(problem.seen.transpose()),
        root_(cholesky_root<6>(problem.prior_weight * problem.prior.information).value_or(Matrix6::Zero())),
        T_prior_start_(problem.prior.T_map_base.inverse() * problem.T_map_base) {
    for (const FeatureMatch& match : problem.matches) count_ += match.line ? 2 : 1;
  }

  [[nodiscard]] int NumResiduals() const { return count_ + 6; }

  bool operator()(const double* change, double* residuals, double* jacobian) const {
    const Vector6 x = Eigen::Map<const Vector6>(change);
    const Vector6 d = seen_ * x;  // the part of x that the features constrain
    const Pose T = problem_.T_map_base * exp_of(d);
    const Eigen::Matrix3d to_base = T.linear().transpose();
    Residuals r(residuals, NumResiduals());
    Rows* J = jacobian != nullptr ? &rows_ : nullptr;
    if (J != nullptr) J->resize(6, NumResiduals());
    Eigen::Index at = 0;
    for (const FeatureMatch& match : problem_.matches) {
      const Eigen::Vector3d off = match.weight * (T * match.point - match.mean);
      if (match.line)
        add_line(match, off, to_base, at, r, J);
      else
        add_plane(match, off, to_base, at, r, J);
      at += match.line ? 2 : 1;
    }
    // The prior applies to the whole change, also in directions that the features do not constrain.
    const Vector6 off = log_of(T_prior_start_ * exp_of(x));
    r.tail<6>() = root_ * off;
    if (J == nullptr) return true;
    const Matrix6 ad = small_adjoint(d);  // right Jacobian of SE(3), to the second order
    const Matrix6 by_change = (Matrix6::Identity() - 0.5 * ad + ad * ad / 6.0) * seen_;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 6>> out(jacobian, NumResiduals(), 6);
    out.topRows(at).noalias() = J->leftCols(at).transpose() * by_change;
    const Matrix6 to = small_adjoint(off), from = small_adjoint(x);
    out.bottomRows<6>() = root_ * (Matrix6::Identity() + 0.5 * to + to * to / 12.0) *
                          (Matrix6::Identity() - 0.5 * from + from * from / 6.0);
    return true;
  }

 private:
  using Residuals = Eigen::Map<Eigen::VectorXd>;
  using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic>;

  /// Huber loss: the factor on a distance, and the derivative of the product by the distance.
  struct Loss {
    double factor = 1, slope = 1;
  };
  [[nodiscard]] Loss robust(double s) const {
    const double a = problem_.kernel;
    if (s <= a) return {};
    const double root = std::sqrt(2 * a * s - a * a);
    return {root / s, a / root};
  }

  /// Adds the distance from a plane. `off`: weighted offset of the point from the shape's mean, in map; `to_base`
  /// rotates it into base_link's axes.
  void add_plane(const FeatureMatch& match, const Eigen::Vector3d& off, const Eigen::Matrix3d& to_base, Eigen::Index at,
                 Residuals& r, Rows* J) const {
    const double distance = match.axis.dot(off);
    const Loss loss = robust(std::abs(distance));
    r[at] = loss.factor * distance;
    if (J != nullptr) set_row(*J, at, match, loss.slope * (to_base * match.axis));
  }

  /// Adds the distance from a line, along two directions across it.
  void add_line(const FeatureMatch& match, const Eigen::Vector3d& off, const Eigen::Matrix3d& to_base, Eigen::Index at,
                Residuals& r, Rows* J) const {
    const Eigen::Vector3d across = off - match.axis.dot(off) * match.axis;
    const Eigen::Vector3d u = match.axis.unitOrthogonal(), v = match.axis.cross(u);
    const Loss loss = robust(across.norm());
    r[at] = loss.factor * u.dot(off);
    r[at + 1] = loss.factor * v.dot(off);
    if (J == nullptr) return;
    // The loss is non-linear along the distance only.
    const Eigen::Vector3d along = across.norm() > 0 ? Eigen::Vector3d(across.normalized()) : u;
    for (const Eigen::Vector3d& n : {u, v}) {
      const Eigen::Vector3d bent = loss.factor * n + (loss.slope - loss.factor) * n.dot(along) * along;
      set_row(*J, at++, match, to_base * bent);
    }
  }

  /// The derivative, by the pose, of the match's weighted offset along `n` (base_link axes).
  static void set_row(Rows& J, Eigen::Index at, const FeatureMatch& match, const Eigen::Vector3d& n) {
    J.col(at) << match.weight * n, match.weight * match.point.cross(n);
  }

  const LoamProblem& problem_;
  Matrix6 seen_;
  Matrix6 root_;
  Pose T_prior_start_;
  int count_ = 0;
  mutable Rows rows_;  // scratch
};

}  // namespace

Vector6 solve_loam(const LoamProblem& problem) {
  const LoamResiduals residuals(problem);
  ceres::TinySolver<LoamResiduals> solver;
  solver.options.max_num_iterations = 6;  // the first evaluation is one; the matches change before more pays off
  solver.options.function_tolerance = 1e-4 * residuals.NumResiduals();
  Vector6 change = Vector6::Zero();
  solver.Solve(residuals, &change);
  return change;
}

}  // namespace curbstone::mapper::registration
