#include "tools/calibrate/calibration_solver.hpp"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/calibrate/calibration_residuals.hpp"

namespace curbstone::calibrate {

namespace {

constexpr int kRounds = 4;            // of solving and estimating the noise
constexpr double kRobustWidth = 4.0;  // sigma of a block beyond which it counts as an outlier
constexpr double kCamber = 0.01;      // rad, 1 sigma: roads have a crossfall of 2 %, less in bends and at junctions
constexpr NoiseLevels kFirstGuess = {0.01, 0.01, 0.01, 0.005, 0.002, 0.002, 0.05};

/// Lower bounds of the noise, however small the residuals: errors of tyres, roads and maps are larger, and systematic.
constexpr NoiseLevels kMinNoise = {0.002, 0.003, 0.003, 0.002, 5e-4, 3e-4, 0.01};

}  // namespace

class CalibrationSolver::Problem {
  /// All estimated quantities; the first 15 are those of Calibrated, in its order.
  struct Unknowns {
    std::array<double, 3> wheels;                   // both radii, track, m
    std::array<double, 6> lidar;                    // T_base_lidar: x y z roll pitch yaw
    std::array<double, 6> imu;                      // T_base_imu
    std::array<double, 3> gyro_bias = {};           // rad/s, in addition to the one subtracted before
    std::array<double, 3> accelerometer_bias = {};  // m/s^2
    std::array<double, 2> level = {};               // rad, about x and y: of the map against gravity
    std::array<double, 1> camber = {};              // rad, roll of the road under the vehicle
  };
  static constexpr std::size_t kUnknownCount = 24;

 public:
  Problem(const std::vector<CalibrationSegment>& segments, const VehicleConfig& vehicle) {
    x_.wheels = {vehicle.wheel_radius, vehicle.wheel_radius, vehicle.track_width};
    std::copy_n(vehicle.lidar.begin(), 6, x_.lidar.begin());
    std::copy_n(vehicle.imu.begin(), 6, x_.imu.begin());
    add_prior(x_.wheels, {0.05 * vehicle.wheel_radius, 0.05 * vehicle.wheel_radius, 0.1 * vehicle.track_width});
    add_prior(x_.lidar, {0.5, 0.5, 0.5, 0.1, 0.1, 0.1});
    add_prior(x_.imu, {0.5, 0.5, 0.5, 0.1, 0.1, 0.1});
    add_prior(x_.gyro_bias, {0.01, 0.01, 0.01});
    add_prior(x_.accelerometer_bias, {0.2, 0.2, 0.2});
    add_prior(x_.level, {0.1, 0.1});
    add_prior(x_.camber, {kCamber});
    for (std::size_t i = 0; i < segments.size(); ++i) {
      add(residuals::WheelsAgainstLidar{segments[i], vehicle.track_width, noise_}, x_.wheels, x_.lidar, x_.camber);
      add(residuals::GyroAgainstLidar{segments[i], noise_}, x_.lidar, x_.imu, x_.gyro_bias);
      if (!segments[i].follows) continue;
      add(residuals::AccelerometerAgainstLidar{segments[i - 1], segments[i], noise_}, x_.lidar, x_.imu,
          x_.accelerometer_bias, x_.level);
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

  /// J^T J of all residuals, including priors and weights of the robust loss.
  [[nodiscard]] Eigen::MatrixXd information() {
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = {
        x_.wheels.data(), x_.lidar.data(), x_.imu.data(), x_.gyro_bias.data(), x_.accelerometer_bias.data(),
        x_.level.data(),  x_.camber.data()};
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
  [[nodiscard]] std::array<double, kCalibratedCount> prior_sigma() const {
    std::array<double, kCalibratedCount> out;
    std::copy_n(prior_sigma_.begin(), kCalibratedCount, out.begin());
    return out;
  }
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
    const Eigen::Map<const Eigen::VectorXd> sigmas(sigma.data(), static_cast<Eigen::Index>(N));
    const Eigen::Map<const Eigen::VectorXd> means(x.data(), static_cast<Eigen::Index>(N));
    const Eigen::MatrixXd weights = sigmas.cwiseInverse().asDiagonal();
    problem_.AddResidualBlock(new ceres::NormalPrior(weights, means), nullptr, x.data());
    std::copy(sigma.begin(), sigma.end(), prior_sigma_.begin() + static_cast<std::ptrdiff_t>(priors_));
    priors_ += N;
  }
  template <class Functor, std::size_t... N>
  void add(const Functor& functor, std::array<double, N>&... parameters) {
    using Listed = residuals::Listed<Functor, sizeof...(N)>;
    auto* cost = new ceres::DynamicAutoDiffCostFunction<Listed, residuals::kDerivatives>(new Listed{functor});
    (cost->AddParameterBlock(static_cast<int>(N)), ...);
    cost->SetNumResiduals(static_cast<int>(Functor::kKinds.size()));
    const auto id = problem_.AddResidualBlock(cost, new ceres::CauchyLoss(kRobustWidth), parameters.data()...);
    blocks_.push_back({id, {Functor::kKinds.begin(), Functor::kKinds.end()}});
  }

  /// From the median of the absolute residuals of each kind, which is robust to outliers.
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
      noise_[kind] = std::max(kMinNoise[kind], noise_[kind] * 1.4826 * *middle);
    }
  }

  Unknowns x_;
  NoiseLevels noise_ = kFirstGuess;
  std::array<double, kUnknownCount> prior_sigma_ = {};
  std::size_t priors_ = 0;
  std::vector<Block> blocks_;
  ceres::Problem problem_;
};

CalibrationSolver::CalibrationSolver(const std::vector<CalibrationSegment>& segments, const VehicleConfig& vehicle)
    : problem_(std::make_unique<Problem>(segments, vehicle)) {}
CalibrationSolver::~CalibrationSolver() = default;

void CalibrationSolver::solve() {
  problem_->solve();
}
std::array<double, kCalibratedCount> CalibrationSolver::values() const {
  return problem_->values();
}
Eigen::MatrixXd CalibrationSolver::information() const {
  return problem_->information();
}
std::array<double, kCalibratedCount> CalibrationSolver::prior_sigma() const {
  return problem_->prior_sigma();
}
const NoiseLevels& CalibrationSolver::noise() const {
  return problem_->noise();
}

}  // namespace curbstone::calibrate
