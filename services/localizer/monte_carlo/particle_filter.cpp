#include "services/localizer/monte_carlo/particle_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <tuple>

namespace curbstone::localizer::monte_carlo {
namespace {

constexpr double kMinUpright = 0.4;    // m above the map's ground: a point on an upright structure,
constexpr double kMaxUpright = 1.9;    // m
constexpr double kFar = 0.6;           // m: maximum distance of the nearest structure in the map's fields
constexpr double kBucket = 0.5;        // m
constexpr double kBucketYaw = 0.175;   // rad
constexpr double kHeightSigma = 0.05;  // m, and
constexpr double kTiltSigma = 0.01;    // rad: of quantities that a filter in the plane does not estimate

std::uint64_t hashed(std::uint64_t x) {  // splitmix64
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Distance from the nearest piece of an upright structure, m.
double distance_at(double x, double y, fields::SavedMap& map) {
  const auto there = map.upright_at(x, y);
  if (!there) return kFar;
  const Eigen::Vector2d off = Eigen::Vector2d(x, y) - there->centre;
  return std::min(kFar, there->normal.isZero() ? off.norm() : std::abs(there->normal.dot(off)));
}

}  // namespace

ParticleFilter::ParticleFilter(const tracking::PoseBelief& start, const MonteCarloConfig& config,
                               const tracking::TrackingConfig& odometry)
    : config_(config), odometry_(odometry), belief_(start) {
  particles_.resize(static_cast<std::size_t>(config.particles));
  const Eigen::Vector3d p = start.T_map_base.translation();
  const double yaw = roll_pitch_yaw(start.T_map_base.linear()).z();
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    particles_[i].x = p.x() + std::sqrt(start.covariance(0, 0)) * normal(i, 0);
    particles_[i].y = p.y() + std::sqrt(start.covariance(1, 1)) * normal(i, 1);
    particles_[i].yaw = yaw + std::sqrt(start.covariance(5, 5)) * normal(i, 2);
  }
}

double ParticleFilter::uniform(std::size_t particle, int draw) const {
  const auto seed = static_cast<std::uint64_t>(config_.seed);
  const std::uint64_t bits =
      hashed(hashed(hashed(seed) ^ update_) ^ (particle * 16 + static_cast<std::uint64_t>(draw)));
  return (static_cast<double>(bits >> 11) + 0.5) * 0x1p-53;
}

double ParticleFilter::normal(std::size_t particle, int draw) const {
  const double u = uniform(particle, 2 * draw), v = uniform(particle, 2 * draw + 1);
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}

tracking::PoseFit ParticleFilter::track(const tracking::ThinnedScan& scan, const tracking::Motion& motion,
                                        fields::SavedMap& map) {
  T_update_base_ = normalised(T_update_base_ * motion.T_last_base);
  belief_.T_map_base = normalised(belief_.T_map_base * motion.T_last_base);
  const bool is_due = update_ == 0 || T_update_base_.translation().norm() >= config_.update_m ||
                      angle_of(T_update_base_) >= config_.update_rad;
  if (is_due) {
    ++update_;
    move(T_update_base_);
    T_update_base_ = Pose::Identity();
    weigh(scan.points, map);
    resample();
    summarise(map);
  }
  tracking::PoseFit fit;
  fit.belief = belief_;
  return fit;
}

void ParticleFilter::move(const Pose& motion) {
  const Eigen::Vector3d way = motion.translation();
  const double turned = roll_pitch_yaw(motion.linear()).z();
  const double sigma = odometry_.odometry_floor_m + odometry_.odometry_m * way.head<2>().norm();
  const double sigma_yaw =
      odometry_.odometry_floor_rad + odometry_.odometry_rad * (std::abs(turned) + way.head<2>().norm());
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    Particle& p = particles_[i];
    const double x = way.x() + sigma * normal(i, 0), y = way.y() + sigma * normal(i, 1);
    p.x += std::cos(p.yaw) * x - std::sin(p.yaw) * y;
    p.y += std::sin(p.yaw) * x + std::cos(p.yaw) * y;
    p.yaw += turned + sigma_yaw * normal(i, 2);
  }
}

void ParticleFilter::weigh(const std::vector<Eigen::Vector3d>& points, fields::SavedMap& map) {
  std::vector<Eigen::Vector2d> upright;  // levelled, in the plane of base_link
  const Eigen::Vector3d rpy = roll_pitch_yaw(belief_.T_map_base.linear());
  const Eigen::Matrix3d lean = rotation_from_rpy(rpy.x(), rpy.y(), 0);
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d q = belief_.T_map_base * p;
    const auto ground = map.ground_at(q.x(), q.y());
    const double above = q.z() - (ground ? ground->height : map.level_at(q.x(), q.y()));
    if (above > kMinUpright && above < kMaxUpright) upright.emplace_back((lean * p).head<2>());
  }
  const auto beams = std::min(upright.size(), static_cast<std::size_t>(config_.beams));
  double sum = 0;
  for (Particle& particle : particles_) {
    const double c = std::cos(particle.yaw), s = std::sin(particle.yaw);
    double weight = 1;
    for (std::size_t i = 0; i < beams; ++i) {
      const Eigen::Vector2d& p = upright[i * upright.size() / beams];
      const double d = distance_at(particle.x + c * p.x() - s * p.y(), particle.y + s * p.x() + c * p.y(), map);
      const double likelihood =
          config_.z_hit * std::exp(-0.5 * d * d / (config_.sigma_hit * config_.sigma_hit)) + config_.z_rand;
      weight += likelihood * likelihood * likelihood;  // as AMCL does: a product would deplete the particles
    }
    particle.weight *= weight;
    sum += particle.weight;
  }
  for (Particle& particle : particles_) particle.weight /= sum;
}

/// The number of particles that, with the configured certainty, differ little from the distribution they are drawn
/// from.
std::size_t ParticleFilter::wanted() const {
  const auto bucket = [](double v, double width) { return static_cast<std::int64_t>(std::floor(v / width)); };
  std::set<std::tuple<std::int64_t, std::int64_t, std::int64_t>> buckets;
  for (const Particle& p : particles_)
    buckets.emplace(bucket(p.x, kBucket), bucket(p.y, kBucket), bucket(p.yaw, kBucketYaw));
  const auto most = static_cast<double>(config_.particles), least = std::min<double>(config_.min_particles, most);
  const auto k = static_cast<double>(buckets.size());
  if (k < 2) return static_cast<std::size_t>(least);
  const double a = 2 / (9 * (k - 1));
  const double n = (k - 1) / (2 * config_.kld_error) * std::pow(1 - a + std::sqrt(a) * config_.kld_quantile, 3);
  return static_cast<std::size_t>(std::clamp(std::ceil(n), least, most));
}

void ParticleFilter::resample() {
  const std::size_t count = wanted();
  const double step = 1.0 / static_cast<double>(count);
  double target = step * uniform(particles_.size(), 0);
  double reached = particles_.front().weight;
  std::vector<Particle> drawn;
  drawn.reserve(count);
  for (std::size_t i = 0; drawn.size() < count; target += step) {
    while (reached < target && i + 1 < particles_.size()) reached += particles_[++i].weight;
    drawn.push_back(particles_[i]);
    drawn.back().weight = step;
  }
  particles_ = std::move(drawn);
}

void ParticleFilter::summarise(fields::SavedMap& map) {
  const Eigen::Vector3d rpy = roll_pitch_yaw(belief_.T_map_base.linear());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const auto off = [&](const Particle& p) {
    return Eigen::Vector3d(p.x, p.y, rpy.z() + std::remainder(p.yaw - rpy.z(), 2 * std::numbers::pi));
  };
  const auto n = static_cast<double>(particles_.size());
  for (const Particle& p : particles_) mean += off(p) / n;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Particle& p : particles_) spread += (off(p) - mean) * (off(p) - mean).transpose() / n;
  const auto ground = map.ground_at(mean.x(), mean.y());
  belief_.T_map_base.translation().head<2>() = mean.head<2>();
  if (ground) belief_.T_map_base.translation().z() = ground->height;
  belief_.T_map_base.linear() = rotation_from_rpy(rpy.x(), rpy.y(), mean.z());
  belief_.covariance.setZero();
  belief_.covariance.diagonal() << 0, 0, kHeightSigma * kHeightSigma, kTiltSigma * kTiltSigma, kTiltSigma * kTiltSigma,
      0;
  constexpr int kRows[3] = {0, 1, 5};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) belief_.covariance(kRows[i], kRows[j]) = spread(i, j);
  }
  belief_.covariance += 1e-9 * tracking::Matrix6::Identity();  // never singular, even for identical particles
}

}  // namespace curbstone::localizer::monte_carlo
