#include "services/mapper/loam_solver.hpp"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <memory>

namespace curbstone {
namespace {

/// The adjoint of a small twist: translation, then rotation.
Matrix6 small_adjoint(const Vector6& x) {
  Matrix6 out = Matrix6::Zero();
  out.topLeftCorner<3, 3>() = out.bottomRightCorner<3, 3>() = skew(x.tail<3>());
  out.topRightCorner<3, 3>() = skew(x.head<3>());
  return out;
}

/// Where the pose is while Ceres tries changes of it, made once for all residuals.
class SharedPose final : public ceres::EvaluationCallback {
 public:
  SharedPose(const LoamProblem& problem, const double* change)
      : start_(problem.T_map_base), seen_(problem.seen.transpose()), change_(change) {}

  void PrepareForEvaluation(bool, bool new_point) override {
    if (!new_point && ready_) return;
    ready_ = true;
    const Vector6 d = seen_ * Eigen::Map<const Vector6>(change_);
    T_ = start_ * exp_of(d);
    const Matrix6 ad = small_adjoint(d);  // right Jacobian of SE(3), to the second order
    jacobian_ = (Matrix6::Identity() - 0.5 * ad + ad * ad / 6.0) * seen_;
  }
  [[nodiscard]] const Pose& T() const { return T_; }
  [[nodiscard]] const Matrix6& jacobian() const { return jacobian_; }

 private:
  Pose start_;
  Matrix6 seen_;
  const double* change_;
  bool ready_ = false;
  Pose T_ = Pose::Identity();
  Matrix6 jacobian_ = Matrix6::Identity();
};

/// Distance to a plane, or along one of two directions across a line.
Eigen::Matrix<double, 1, 6> row(const FeatureMatch& match, const Eigen::Vector3d& direction, const SharedPose& pose) {
  const Eigen::Vector3d n = pose.T().linear().transpose() * direction;
  Eigen::Matrix<double, 1, 6> J;
  J << n.transpose(), match.point.cross(n).transpose();
  return match.weight * J * pose.jacobian();
}

class PlaneDistance final : public ceres::SizedCostFunction<1, 6> {
 public:
  PlaneDistance(const FeatureMatch& match, const SharedPose& pose) : match_(match), pose_(pose) {}
  bool Evaluate(double const* const*, double* residual, double** jacobians) const override {
    residual[0] = match_.weight * match_.axis.dot(pose_.T() * match_.point - match_.mean);
    if (jacobians != nullptr && jacobians[0] != nullptr)
      Eigen::Map<Eigen::Matrix<double, 1, 6>>{jacobians[0]} = row(match_, match_.axis, pose_);
    return true;
  }

 private:
  const FeatureMatch& match_;
  const SharedPose& pose_;
};

class LineDistance final : public ceres::SizedCostFunction<2, 6> {
 public:
  LineDistance(const FeatureMatch& match, const SharedPose& pose)
      : match_(match), pose_(pose), u_(match.axis.unitOrthogonal()), v_(match.axis.cross(u_)) {}
  bool Evaluate(double const* const*, double* residual, double** jacobians) const override {
    const Eigen::Vector3d off = pose_.T() * match_.point - match_.mean;
    residual[0] = match_.weight * u_.dot(off);
    residual[1] = match_.weight * v_.dot(off);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 6, Eigen::RowMajor>> J(jacobians[0]);
      J.row(0) = row(match_, u_, pose_);
      J.row(1) = row(match_, v_, pose_);
    }
    return true;
  }

 private:
  const FeatureMatch& match_;
  const SharedPose& pose_;
  Eigen::Vector3d u_, v_;
};

/// How far the pose is from the prior. Sees the whole change, also where the features say nothing.
class PriorDistance final : public ceres::SizedCostFunction<6, 6> {
 public:
  explicit PriorDistance(const LoamProblem& problem) : problem_(problem) {
    root_ = Matrix6((problem.prior_weight * problem.prior.information).llt().matrixU());
  }
  bool Evaluate(double const* const* change, double* residual, double** jacobians) const override {
    const Vector6 d = Eigen::Map<const Vector6>(change[0]);
    const Vector6 off = log_of(problem_.prior.T_map_base.inverse() * problem_.T_map_base * exp_of(d));
    Eigen::Map<Vector6> out(residual);
    out = root_ * off;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      const Matrix6 to = small_adjoint(off), from = small_adjoint(d);
      Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>{jacobians[0]} =
          root_ * (Matrix6::Identity() + 0.5 * to + to * to / 12.0) *
          (Matrix6::Identity() - 0.5 * from + from * from / 6.0);
    }
    return true;
  }

 private:
  const LoamProblem& problem_;
  Matrix6 root_;
};

}  // namespace

Vector6 solve_loam(const LoamProblem& problem) {
  Vector6 change = Vector6::Zero();
  SharedPose pose(problem, change.data());
  ceres::Problem::Options owner;
  owner.evaluation_callback = &pose;
  owner.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  owner.enable_fast_removal = false;
  owner.disable_all_safety_checks = true;
  ceres::HuberLoss robust(problem.kernel);
  ceres::Problem ceres_problem(owner);
  ceres_problem.AddParameterBlock(change.data(), 6);
  for (const FeatureMatch& match : problem.matches) {
    ceres::CostFunction* distance = nullptr;
    if (match.line) {
      distance = new LineDistance(match, pose);
    } else {
      distance = new PlaneDistance(match, pose);
    }
    ceres_problem.AddResidualBlock(distance, &robust, change.data());
  }
  ceres_problem.AddResidualBlock(new PriorDistance(problem), nullptr, change.data());

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.dense_linear_algebra_library_type = ceres::EIGEN;
  options.num_threads = 1;
  options.max_num_iterations = 3;  // the matches change before it is worth more
  options.function_tolerance = 1e-4;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  return summary.IsSolutionUsable() ? change : Vector6::Zero();
}

}  // namespace curbstone
