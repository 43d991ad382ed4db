#include "services/localizer/tracking/pose_fit.hpp"

#include <algorithm>
#include <cmath>

#include "common/linear/decompositions.hpp"

namespace curbstone::localizer::tracking {
namespace {

constexpr int kMaxIterations = 5;
constexpr double kDone = 1e-3;        // m or rad of a step: the next step is far smaller
constexpr double kNearlyDone = 3e-3;  // m or rad
constexpr std::size_t kCoarsely = 3;  // one of this many points is used, before all are
constexpr std::size_t kEnoughPoints = 600;
constexpr double kGroundBand = 0.22;          // m from the map's ground: a ground point
constexpr double kMinUpright = 0.4;           // m above it: a point on an upright structure,
constexpr double kMaxUpright = 1.9;           // m: the upper limit of the map's classes
constexpr double kLevel = 0.1;                // slope between cells
constexpr double kGroundMatched = 0.06;       // m
constexpr double kWallMatched = 0.10;         // m
constexpr int kFewPoints = 40;                // of either kind: too few to tell whether the map fits
constexpr int kPlane = 0b11;                  // bits of PoseFit::degenerate
constexpr double kObservablePosition = 0.10;  // m, 1 sigma by the revolution alone, below which an axis is observable
constexpr double kObservableRotation = 0.01;  // rad

/// The contribution of the points to the normal equations.
struct NormalSums {
  Matrix6 information = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  double squares = 0;
  int matched = 0;

  void add(const Vector6& J, double residual, double sigma, double let_go) {
    const double ratio = residual / let_go;
    const double root = 1.0 / (1.0 + ratio * ratio);
    const double weight = root * root / (sigma * sigma);
    information.noalias() += weight * J * J.transpose();
    gradient.noalias() += weight * residual * J;
  }
  /// `times`: what one of the other's points stands for.
  void add(const NormalSums& other, double times) {
    information += times * other.information;
    gradient += times * other.gradient;
  }
};

/// Derivative of `direction` . (R exp(w) p + t) by (t, w).
Vector6 derivative(const Eigen::Vector3d& direction, const Eigen::Matrix3d& R, const Eigen::Vector3d& p) {
  Vector6 J;
  J << direction, p.cross(R.transpose() * direction);
  return J;
}

/// What the points of a revolution tell about one pose, and how many of them match the map there.
class PointSums {
 public:
  PointSums(const Pose& T_map_base, fields::SavedMap& map, const TrackingConfig& config)
      : T_(T_map_base), R_(T_map_base.linear()), map_(map), config_(config) {}

  /// Takes one of `every` points, and all of the paint.
  void add(const ThinnedScan& scan, std::size_t every) {
    for (std::size_t i = 0; i < scan.points.size(); i += every) add_point(scan.points[i]);
    if (!config_.use_paint) return;
    for (const Eigen::Vector3d& p : scan.paint) add_paint(p);
  }

  NormalSums structure;  // of ground and upright points
  NormalSums paint;
  PoseFit counts;

 private:
  void add_point(const Eigen::Vector3d& p) {
    const Eigen::Vector3d q = T_ * p;
    const auto ground = map_.ground_at(q.x(), q.y());
    const double above = q.z() - (ground ? ground->height : map_.level_at(q.x(), q.y()));
    if (ground && std::abs(above) < kGroundBand) return add_ground(p, *ground, above);
    if (above > kMinUpright && above < kMaxUpright) add_upright(p, q);
  }

  /// A point that may be of paint. On the map's paint it tells nothing, beside it how far it is off.
  void add_paint(const Eigen::Vector3d& p) {
    const Eigen::Vector3d q = T_ * p;
    const auto offset = map_.paint().offset_at(q.x(), q.y());
    if (!offset || offset->isZero()) return;
    const double distance = offset->norm();
    const Eigen::Vector3d n(offset->x() / distance, offset->y() / distance, 0);
    paint.add(derivative(n, R_, p), distance, config_.paint_sigma, 3 * config_.paint_sigma);
  }

  void add_ground(const Eigen::Vector3d& p, const fields::SavedMap::Ground& ground, double above) {
    ++counts.grounds;
    if (std::abs(above) < kGroundMatched) count_match(counts.grounds_matched, above);
    // Level ground, even with its slope ignored, determines roll and pitch, which walls cannot.
    const bool tells = config_.heights == Heights::kAll || (config_.heights == Heights::kCurbs && ground.by_curb);
    if (!tells && ground.slope.norm() > kLevel) return;
    const Eigen::Vector2d slope = tells ? ground.slope : Eigen::Vector2d::Zero();
    const Eigen::Vector3d up(-slope.x(), -slope.y(), 1);
    structure.add(derivative(up, R_, p), above, config_.height_sigma, 2 * config_.height_sigma);
  }

  void add_upright(const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    ++counts.uprights;
    const auto there = map_.upright_at(q.x(), q.y());
    if (!there) return;
    const Eigen::Vector2d off = q.head<2>() - there->centre;
    const bool is_line = !there->normal.isZero();
    const double distance = is_line ? there->normal.dot(off) : off.norm();
    if (std::abs(distance) < kWallMatched) count_match(counts.uprights_matched, distance);
    if (!config_.use_walls) return;
    const double let_go = 3 * config_.wall_sigma;
    if (is_line) {
      const Eigen::Vector3d n(there->normal.x(), there->normal.y(), 0);
      return structure.add(derivative(n, R_, p), distance, config_.wall_sigma, let_go);
    }
    structure.add(derivative(Eigen::Vector3d::UnitX(), R_, p), off.x(), 2 * config_.wall_sigma, let_go);
    structure.add(derivative(Eigen::Vector3d::UnitY(), R_, p), off.y(), 2 * config_.wall_sigma, let_go);
  }

  void count_match(int& matched, double residual) {
    ++matched;
    ++structure.matched;
    structure.squares += residual * residual;
  }

  const Pose& T_;
  Eigen::Matrix3d R_;
  fields::SavedMap& map_;
  const TrackingConfig& config_;
};

/// The covariance of the pose by the revolution alone.
Matrix6 covariance_of(const Matrix6& information) {
  return inverse(information + 1e-3 * Matrix6::Identity());
}

/// What ground and upright structures tell of the pose.
struct StructureSums {
  NormalSums sums;
  int directions = 2;  ///< in the plane, that they constrain
};

/// The sums without what they tell about directions in the plane that they hardly constrain. There the noise of the map
/// looks like a little information, the same in each revolution, and would sum up to a certainty that is none (Zhang,
/// Kaess and Singh 2016).
StructureSums without_weak_directions(const NormalSums& sums, double independent) {
  StructureSums strong{sums};
  const auto plane = eigen_pairs<2>(covariance_of(independent * sums.information).topLeftCorner<2, 2>());
  for (int i = 0; i < 2; ++i) {
    if (plane.values(i) < kObservablePosition * kObservablePosition) continue;
    Matrix6 rest = Matrix6::Identity();
    rest.topLeftCorner<2, 2>() -= plane.vectors.col(i) * plane.vectors.col(i).transpose();
    strong.sums.information = rest * strong.sums.information * rest;
    strong.sums.gradient = rest * strong.sums.gradient;
    --strong.directions;
  }
  return strong;
}

/// The axes of base_link along which the revolution alone does not constrain the pose: bit i for axis i.
int unobservable_axes(const Matrix6& information, const Eigen::Matrix3d& R) {
  Matrix6 to_base = Matrix6::Identity();
  to_base.topLeftCorner<3, 3>() = R.transpose();
  const Matrix6 covariance = to_base * covariance_of(information) * to_base.transpose();
  int unobservable = 0;
  for (int i = 0; i < 6; ++i) {
    const double most = i < 3 ? kObservablePosition : kObservableRotation;
    if (!(covariance(i, i) < most * most)) unobservable |= 1 << i;
  }
  return unobservable;
}

}  // namespace

double PoseFit::matched_share() const {
  if (uprights < kFewPoints || grounds < kFewPoints) return 0;
  return std::min(static_cast<double>(uprights_matched) / uprights, static_cast<double>(grounds_matched) / grounds);
}

double PoseFit::held_share() const {
  const bool bare = uprights < kFewPoints && grounds >= kFewPoints;
  return bare ? static_cast<double>(grounds_matched) / grounds : matched_share();
}

bool PoseFit::fits_but_slides(double min_share) const {
  return (degenerate & kPlane) != 0 && held_share() >= min_share;
}

Pose moved_by(const Pose& pose, const Vector6& error) {
  Pose moved = pose;
  moved.translation() += error.head<3>();
  moved.linear() = pose.linear() * so3_exp(error.tail<3>()).toRotationMatrix();
  return moved;
}

Vector6 error_between(const Pose& from, const Pose& to) {
  Vector6 error;
  error << to.translation() - from.translation(), so3_log(Eigen::Quaterniond(from.linear().transpose() * to.linear()));
  return error;
}

PoseFit fit_pose(const ThinnedScan& scan, const PoseBelief& prior, fields::SavedMap& map, const TrackingConfig& config,
                 double new_share) {
  const double share = config.independent * new_share;
  const Matrix6 prior_information = inverse(prior.covariance);
  Pose pose = prior.T_map_base;
  std::size_t every = scan.points.size() < kEnoughPoints ? 1 : kCoarsely;
  for (int iteration = 1;; ++iteration) {
    PointSums seen(pose, map, config);
    seen.add(scan, every);
    const auto weight = static_cast<double>(every);
    const StructureSums structure = without_weak_directions(seen.structure, config.independent * weight);
    if (structure.directions == 0) seen.paint = {};  // by paint alone, one line looks like the next one
    NormalSums sums;
    sums.add(structure.sums, weight);
    sums.add(seen.paint, 1);
    const Matrix6 information = prior_information + share * sums.information;
    const Vector6 gradient = prior_information * error_between(prior.T_map_base, pose) + share * sums.gradient;
    const Vector6 step = -Ldlt<6>(information).solve(gradient);
    pose = normalised(moved_by(pose, step));
    const double moved = step.cwiseAbs().maxCoeff();
    if (every > 1) {  // first iterations with some of the points, the last ones with all
      if (moved < kNearlyDone || iteration + 1 >= kMaxIterations) every = 1;
      continue;
    }
    if (moved > kDone && iteration < kMaxIterations) continue;
    PoseFit fit = seen.counts;
    fit.belief = {pose, inverse(information)};
    fit.information = sums.information;
    fit.degenerate =
        unobservable_axes(config.independent * (seen.structure.information + seen.paint.information), pose.linear());
    fit.iterations = iteration;
    fit.residual = seen.structure.matched > 0 ? std::sqrt(seen.structure.squares / seen.structure.matched) : 0;
    return fit;
  }
}

}  // namespace curbstone::localizer::tracking
