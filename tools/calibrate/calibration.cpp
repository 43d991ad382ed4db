#include "tools/calibrate/calibration.hpp"

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "common/gravity.hpp"
#include "tools/calibrate/segment.hpp"

namespace curbstone {

namespace {

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;

constexpr double kPiece = 0.5;  // s
constexpr int kRounds = 4;      // of solving and of finding the noise
constexpr std::size_t kMinSegments = 20;
constexpr double kRobustWidth = 4.0;                  // sigma of a block beyond which it is an outlier
const double kStraight = 1.0 + 2.0 * std::cos(0.02);  // trace of a rotation by 0.02 rad
constexpr double kShare = 0.9;                        // of what is known, told by the drive: observed
constexpr double kOpen = 0.5;  // of the prior's variance left: the drive says nothing in that direction

/// 1 sigma of each kind of residual, found from the residuals.
enum NoiseKind : std::size_t { kAlong, kSideways, kUpwards, kTilt, kTurn, kGyro, kSpeed, kNoiseCount };
using NoiseLevels = std::array<double, kNoiseCount>;
constexpr NoiseLevels kFirstGuess = {0.01, 0.01, 0.01, 0.005, 0.002, 0.002, 0.05};

/// Not less, however well all agrees: tyres, roads and maps bend by more, and always the same way.
constexpr NoiseLevels kLeast = {0.002, 0.003, 0.003, 0.002, 5e-4, 3e-4, 0.01};

/// Everything that is solved for; the first 15 are Calibrated's, in its order.
struct Unknowns {
  std::array<double, 3> wheels;                   // both radii, track, m
  std::array<double, 6> lidar;                    // T_base_lidar: x y z roll pitch yaw
  std::array<double, 6> imu;                      // T_base_imu
  std::array<double, 3> gyro_bias = {};           // rad/s, beside what was taken off
  std::array<double, 3> accelerometer_bias = {};  // m/s^2
  std::array<double, 2> level = {};               // rad, about x and y: of the map against gravity
};
constexpr std::size_t kUnknownCount = 23;

template <class T>
Matrix3<T> from_rpy(const T* rpy) {
  return (Eigen::AngleAxis<T>(rpy[2], Vector3<T>::UnitZ()) * Eigen::AngleAxis<T>(rpy[1], Vector3<T>::UnitY()) *
          Eigen::AngleAxis<T>(rpy[0], Vector3<T>::UnitX()))
      .toRotationMatrix();
}

template <class T>
Vector3<T> log_of(const Matrix3<T>& R) {
  Vector3<T> out;
  ceres::RotationMatrixToAngleAxis(ceres::ColumnMajorAdapter3x3(R.data()), out.data());
  return out;
}

template <class T>
Matrix3<T> exp_of(const Vector3<T>& v) {
  Matrix3<T> R;
  ceres::AngleAxisToRotationMatrix(v.data(), ceres::ColumnMajorAdapter3x3(R.data()));
  return R;
}

/// base_link's motion as the LiDAR saw it, against the arcs that the wheels rolled.
struct WheelsAgainstLidar {
  const CalibrationSegment& segment;
  double configured_track;
  const NoiseLevels& noise;
  template <class T>
  bool operator()(const T* wheels, const T* lidar, T* residual) const {
    T x(0.0), y(0.0), heading(0.0);
    for (const auto& turned : segment.wheels) {
      const T left = wheels[0] * turned[0];
      const T right = wheels[1] * turned[1];
      const T turn = (right - left) / wheels[2];
      const T way = 0.5 * (left + right);
      x += way * cos(heading + 0.5 * turn);
      y += way * sin(heading + 0.5 * turn);
      heading += turn;
    }
    const Matrix3<T> R = from_rpy(lidar + 3);
    const Vector3<T> t(lidar[0], lidar[1], lidar[2]);
    const Pose L = segment.T_begin_end();
    const Matrix3<T> R_base = R * L.linear().cast<T>() * R.transpose();
    const Vector3<T> t_base = t + R * L.translation().cast<T>() - R_base * t;
    const Vector3<T> turned = log_of(R_base);
    residual[0] = (t_base.x() - x) / noise[kAlong];
    residual[1] = (t_base.y() - y) / noise[kSideways];
    residual[2] = t_base.z() / noise[kUpwards];
    residual[3] = turned.x() / noise[kTilt];
    residual[4] = turned.y() / noise[kTilt];
    // In metres of the wheels, which are what errs. A piece that hardly turns tells how the radii compare; of the track
    // only noise would speak, and shrink or stretch it to make itself small.
    const double seen = L.linear().trace() > kStraight ? 0.0 : 1.0;
    const T track = seen * wheels[2] + (1.0 - seen) * configured_track;
    residual[5] = (turned.z() * track - heading * wheels[2]) / noise[kTurn];
    return true;
  }
  static constexpr std::array kKinds = {kAlong, kSideways, kUpwards, kTilt, kTilt, kTurn};
};

struct GyroAgainstLidar {
  const CalibrationSegment& segment;
  const NoiseLevels& noise;
  template <class T>
  bool operator()(const T* lidar, const T* imu, const T* gyro_bias, T* residual) const {
    const Matrix3<T> Q = from_rpy(imu + 3).transpose() * from_rpy(lidar + 3);  // lidar to imu
    const Vector3<T> bias(gyro_bias[0], gyro_bias[1], gyro_bias[2]);
    const Matrix3<T> by_gyro =
        segment.imu.rotation.toRotationMatrix().cast<T>() * exp_of<T>(segment.imu.rotation_by_bias.cast<T>() * bias);
    const Matrix3<T> by_lidar = Q * segment.T_begin_end().linear().cast<T>() * Q.transpose();
    const Vector3<T> error = log_of<T>(by_gyro.transpose() * by_lidar);
    for (int i = 0; i < 3; ++i) residual[i] = error[i] / noise[kGyro];
    return true;
  }
  static constexpr std::array kKinds = {kGyro, kGyro, kGyro};
};

/// The IMU's mean velocity in one piece and in the next: it changed by what the accelerometer felt, and gravity.
struct AccelerometerAgainstLidar {
  const CalibrationSegment& a;
  const CalibrationSegment& b;
  const NoiseLevels& noise;
  template <class T>
  bool operator()(const T* lidar, const T* imu, const T* accelerometer_bias, const T* level, T* residual) const {
    const Matrix3<T> R_base_lidar = from_rpy(lidar + 3);
    const Matrix3<T> R_lidar_imu = R_base_lidar.transpose() * from_rpy(imu + 3);
    const Vector3<T> arm =
        R_base_lidar.transpose() * Vector3<T>(imu[0] - lidar[0], imu[1] - lidar[1], imu[2] - lidar[2]);
    const auto at = [&](const Pose& T_map_lidar) -> Vector3<T> {
      return T_map_lidar.translation().cast<T>() + T_map_lidar.linear().cast<T>() * arm;
    };
    const Vector3<T> bias(accelerometer_bias[0], accelerometer_bias[1], accelerometer_bias[2]);
    const Vector3<T> gravity =
        exp_of<T>(Vector3<T>(level[0], level[1], T(0.0))) * Vector3<T>(T(0.0), T(0.0), T(-kGravity));
    const Matrix3<T> R_a = a.T_map_begin.linear().cast<T>() * R_lidar_imu;
    const Matrix3<T> R_b = b.T_map_begin.linear().cast<T>() * R_lidar_imu;
    const T da(a.duration), db(b.duration);
    const Vector3<T> seen = (at(b.T_map_end) - at(b.T_map_begin)) / db - (at(a.T_map_end) - at(a.T_map_begin)) / da;
    const Vector3<T> felt = 0.5 * (da + db) * gravity + R_b * (b.imu.position.cast<T>() / db - 0.5 * db * bias) -
                            R_a * (a.imu.position.cast<T>() / da - 0.5 * da * bias) +
                            R_a * (a.imu.velocity.cast<T>() - da * bias);
    for (int i = 0; i < 3; ++i) residual[i] = (seen[i] - felt[i]) / noise[kSpeed];
    return true;
  }
  static constexpr std::array kKinds = {kSpeed, kSpeed, kSpeed};
};

template <std::size_t N>
struct Prior {
  std::array<double, N> mean, sigma;
  template <class T>
  bool operator()(const T* x, T* residual) const {
    for (std::size_t i = 0; i < N; ++i) residual[i] = (x[i] - mean[i]) / sigma[i];
    return true;
  }
};

/// The least-squares problem of a drive.
class Solver {
 public:
  Solver(const std::vector<CalibrationSegment>& segments, const VehicleConfig& vehicle) {
    x_.wheels = {vehicle.wheel_radius, vehicle.wheel_radius, vehicle.track_width};
    std::copy_n(vehicle.lidar.begin(), 6, x_.lidar.begin());
    std::copy_n(vehicle.imu.begin(), 6, x_.imu.begin());
    add_prior(x_.wheels, {0.05 * vehicle.wheel_radius, 0.05 * vehicle.wheel_radius, 0.1 * vehicle.track_width});
    add_prior(x_.lidar, {0.5, 0.5, 0.5, 0.1, 0.1, 0.1});
    add_prior(x_.imu, {0.5, 0.5, 0.5, 0.1, 0.1, 0.1});
    add_prior(x_.gyro_bias, {0.01, 0.01, 0.01});
    add_prior(x_.accelerometer_bias, {0.2, 0.2, 0.2});
    add_prior(x_.level, {0.1, 0.1});
    for (std::size_t i = 0; i < segments.size(); ++i) {
      add(new ceres::AutoDiffCostFunction<WheelsAgainstLidar, 6, 3, 6>(
              new WheelsAgainstLidar{segments[i], vehicle.track_width, noise_}),
          WheelsAgainstLidar::kKinds, x_.wheels.data(), x_.lidar.data());
      add(new ceres::AutoDiffCostFunction<GyroAgainstLidar, 3, 6, 6, 3>(new GyroAgainstLidar{segments[i], noise_}),
          GyroAgainstLidar::kKinds, x_.lidar.data(), x_.imu.data(), x_.gyro_bias.data());
      if (!segments[i].follows) continue;
      add(new ceres::AutoDiffCostFunction<AccelerometerAgainstLidar, 3, 6, 6, 3, 2>(
              new AccelerometerAgainstLidar{segments[i - 1], segments[i], noise_}),
          AccelerometerAgainstLidar::kKinds, x_.lidar.data(), x_.imu.data(), x_.accelerometer_bias.data(),
          x_.level.data());
    }
  }

  void solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 50;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    for (int round = 0; round < kRounds; ++round) {
      ceres::Solver::Summary summary;
      ceres::Solve(options, &problem_, &summary);
      if (!summary.IsSolutionUsable()) throw std::runtime_error("no calibration fits this drive: " + summary.message);
      if (round + 1 < kRounds) find_noise();
    }
  }

  /// J^T J of everything, priors and weights of the robust loss included.
  [[nodiscard]] Eigen::MatrixXd information() {
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = {
        x_.wheels.data(), x_.lidar.data(), x_.imu.data(), x_.gyro_bias.data(), x_.accelerometer_bias.data(),
        x_.level.data()};
    ceres::CRSMatrix J;
    problem_.Evaluate(options, nullptr, nullptr, nullptr, &J);
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(J.num_cols, J.num_cols);
    for (int row = 0; row < J.num_rows; ++row) {
      const auto first = static_cast<std::size_t>(J.rows[static_cast<std::size_t>(row)]);
      const auto last = static_cast<std::size_t>(J.rows[static_cast<std::size_t>(row) + 1]);
      for (std::size_t i = first; i < last; ++i)
        for (std::size_t j = first; j < last; ++j) H(J.cols[i], J.cols[j]) += J.values[i] * J.values[j];
    }
    return H;
  }
  [[nodiscard]] const std::array<double, kUnknownCount>& prior_sigma() const { return prior_sigma_; }
  [[nodiscard]] const NoiseLevels& noise() const { return noise_; }
  [[nodiscard]] std::array<double, kCalibratedCount> values() const {
    std::array<double, kCalibratedCount> out;
    std::copy(x_.wheels.begin(), x_.wheels.end(), out.begin());
    std::copy(x_.lidar.begin(), x_.lidar.end(), out.begin() + 3);
    std::copy(x_.imu.begin(), x_.imu.end(), out.begin() + 9);
    return out;
  }

 private:
  struct Block {
    ceres::ResidualBlockId id;
    std::vector<NoiseKind> kinds;
  };

  template <std::size_t N>
  void add_prior(std::array<double, N>& x, const std::array<double, N>& sigma) {
    problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Prior<N>, static_cast<int>(N), static_cast<int>(N)>(new Prior<N>{x, sigma}),
        nullptr, x.data());
    std::copy(sigma.begin(), sigma.end(), prior_sigma_.begin() + static_cast<std::ptrdiff_t>(priors_));
    priors_ += N;
  }
  template <std::size_t N, class... Parameters>
  void add(ceres::CostFunction* cost, const std::array<NoiseKind, N>& kinds, Parameters*... parameters) {
    const auto id = problem_.AddResidualBlock(cost, new ceres::CauchyLoss(kRobustWidth), parameters...);
    blocks_.push_back({id, {kinds.begin(), kinds.end()}});
  }

  /// Median of the absolute residuals of each kind: outliers do not move it.
  void find_noise() {
    std::array<std::vector<double>, kNoiseCount> residuals;
    std::array<double, 6> r;
    for (const Block& block : blocks_) {
      problem_.EvaluateResidualBlock(block.id, false, nullptr, r.data(), nullptr);
      for (std::size_t i = 0; i < block.kinds.size(); ++i) residuals[block.kinds[i]].push_back(std::abs(r[i]));
    }
    for (std::size_t kind = 0; kind < kNoiseCount; ++kind) {
      std::vector<double>& all = residuals[kind];
      if (all.empty()) continue;
      const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
      std::nth_element(all.begin(), middle, all.end());
      noise_[kind] = std::max(kLeast[kind], noise_[kind] * 1.4826 * *middle);
    }
  }

  Unknowns x_;
  NoiseLevels noise_ = kFirstGuess;
  std::array<double, kUnknownCount> prior_sigma_ = {};
  std::size_t priors_ = 0;
  std::vector<Block> blocks_;
  ceres::Problem problem_;
};

struct Described {
  const char* name;
  const char* unit;
  double useful;  // 1 sigma that is of use; radii and track: share of themselves
};
constexpr std::array<Described, kCalibratedCount> kDescribed = {{{"wheel_radius.left", "m", 0.005},
                                                                 {"wheel_radius.right", "m", 0.005},
                                                                 {"track_width", "m", 0.02},
                                                                 {"lidar.x", "m", 0.05},
                                                                 {"lidar.y", "m", 0.05},
                                                                 {"lidar.z", "m", 0.05},
                                                                 {"lidar.roll", "rad", 0.01},
                                                                 {"lidar.pitch", "rad", 0.01},
                                                                 {"lidar.yaw", "rad", 0.01},
                                                                 {"imu.x", "m", 0.05},
                                                                 {"imu.y", "m", 0.05},
                                                                 {"imu.z", "m", 0.05},
                                                                 {"imu.roll", "rad", 0.01},
                                                                 {"imu.pitch", "rad", 0.01},
                                                                 {"imu.yaw", "rad", 0.01}}};

std::vector<OpenDirection> open_directions(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& prior) {
  const Eigen::MatrixXd scaled = prior.cwiseInverse().asDiagonal() * covariance * prior.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  std::vector<OpenDirection> out;
  for (Eigen::Index k = 0; k < eigen.eigenvalues().size(); ++k) {
    if (eigen.eigenvalues()[k] < kOpen) continue;
    OpenDirection direction;
    for (std::size_t i = 0; i < kCalibratedCount; ++i) {
      const double part = eigen.eigenvectors()(static_cast<Eigen::Index>(i), k);
      if (std::abs(part) > 0.3) direction.parts.emplace_back(kDescribed[i].name, part);
    }
    out.push_back(std::move(direction));
  }
  return out;
}

}  // namespace

CalibrationResult calibrate(const CalibrationData& data, const VehicleConfig& vehicle) {
  const std::vector<CalibrationSegment> segments = cut_segments(data, kPiece);
  if (segments.size() < kMinSegments)
    throw std::runtime_error(fmt::format(
        "too little to calibrate with: {} pieces of {} s in which the vehicle moves and LiDAR, wheels and IMU "
        "are all heard; {} are needed",
        segments.size(), kPiece, kMinSegments));
  Solver solver(segments, vehicle);
  solver.solve();

  constexpr auto n = static_cast<Eigen::Index>(kCalibratedCount);
  const Eigen::MatrixXd all = solver.information().inverse();
  CalibrationResult result;
  result.covariance = all.topLeftCorner(n, n);
  result.vehicle = vehicle;
  result.segments = static_cast<int>(segments.size());
  for (const CalibrationSegment& s : segments) {
    result.distance += s.T_begin_end().translation().norm();
    result.turned += angle_of(s.T_begin_end());
  }
  result.noise = {solver.noise()[kAlong], solver.noise()[kGyro], solver.noise()[kSpeed]};

  std::array<double, kCalibratedCount> configured = {vehicle.wheel_radius, vehicle.wheel_radius, vehicle.track_width};
  std::copy_n(vehicle.lidar.begin(), 6, configured.begin() + 3);
  std::copy_n(vehicle.imu.begin(), 6, configured.begin() + 9);
  const auto found = solver.values();
  Eigen::VectorXd prior(n);
  for (std::size_t i = 0; i < kCalibratedCount; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    prior[k] = solver.prior_sigma()[i];
    CalibratedValue& v = result.values[i];
    v.name = kDescribed[i].name;
    v.unit = kDescribed[i].unit;
    v.configured = configured[i];
    v.value = found[i];
    v.sigma = std::sqrt(result.covariance(k, k));
    v.share = 1.0 - v.sigma * v.sigma / (prior[k] * prior[k]);
    v.observed = v.share > kShare && v.sigma < kDescribed[i].useful * (i < 3 ? configured[i] : 1.0);
  }
  result.open = open_directions(result.covariance, prior);

  const auto& left = result[Calibrated::kRadiusLeft];
  const auto& right = result[Calibrated::kRadiusRight];
  if (left.observed && right.observed) result.vehicle.wheel_radius = 0.5 * (left.value + right.value);
  if (result[Calibrated::kTrack].observed) result.vehicle.track_width = result[Calibrated::kTrack].value;
  for (std::size_t i = 0; i < 6; ++i) {
    if (result.values[3 + i].observed) result.vehicle.lidar[i] = result.values[3 + i].value;
    if (result.values[9 + i].observed) result.vehicle.imu[i] = result.values[9 + i].value;
  }
  return result;
}

}  // namespace curbstone
