#include "services/mapper/tracking/tracking_state.hpp"

namespace curbstone::mapper::tracking {
namespace {

constexpr std::int64_t kPatience = 1'000'000;   // us without a fit, after which the pose is lost
constexpr int kConfirmed = 10;                  // scans in a row that must fit before a pose is trusted again
constexpr double kUncertaintySpeed = 3.0;       // m/s, growth of the uncertainty while lost or without odometry,
constexpr double kGuidedUncertainty = 0.05;     // and m per metre with odometry
constexpr double kGuidedTurn = 0.005;           // rad, error of odometry's attitude after a metre
constexpr double kMaxUncertainty = 0.5;         // m up to which odometry alone continues the pose over sparse scans
constexpr std::int64_t kNewGround = 6'000'000;  // us without a fit, by when the whole map was searched, and
constexpr double kNewGroundPath = 10.0;         // m by odometry without a fit: the surroundings are new

}  // namespace

bool TrackingState::judge(const ScanResult& scan, Counters& counters) {
  since_fitted_m_ += scan.distance;
  uncertainty_ = uncertainty_after(scan);
  if (scan.fits) {
    take_fit(scan, counters);
    return false;
  }
  take_refusal(scan, counters);
  if (!sees_new_ground(scan)) return false;
  counters.add("began_anew");
  fix_ = Fix::kTracking;
  drift_.setZero();
  trust(scan.utime);
  return true;
}

double TrackingState::uncertainty_after(const ScanResult& scan) const {
  const bool guided = scan.with_odometry && fix_ != Fix::kLost;
  return uncertainty_ + (guided ? kGuidedUncertainty * scan.distance : kUncertaintySpeed * scan.stride);
}

registration::Matrix6 TrackingState::covariance_without(const ScanResult& scan) const {
  registration::Matrix6 covariance = drift_ + scan.covariance;
  const double uncertainty = uncertainty_after(scan);
  covariance.topLeftCorner<3, 3>().diagonal().array() += uncertainty * uncertainty;
  return covariance;
}

void TrackingState::take_fit(const ScanResult& scan, Counters& counters) {
  refused_in_a_row_ = 0;
  drift_.setZero();
  if (fix_ == Fix::kLost) {
    fix_ = Fix::kTentative;
    fitting_ = 0;
  }
  if (fix_ == Fix::kTentative && ++fitting_ >= kConfirmed) {
    counters.add("found");
    fix_ = Fix::kTracking;
  }
  if (fix_ == Fix::kTracking) trust(scan.utime);
}

void TrackingState::take_refusal(const ScanResult& scan, Counters& counters) {
  if (!scan.sparse) ++refused_in_a_row_;
  drift_ += scan.covariance;
  if (fix_ == Fix::kTentative) fix_ = Fix::kLost;
  if (scan.sparse && scan.with_odometry && uncertainty_ < kMaxUncertainty) return;
  if (fix_ == Fix::kTracking && scan.utime - last_fit_ > kPatience) {
    counters.add("lost.refused");
    fix_ = Fix::kLost;
    blind_ = false;
    if (!scan.with_odometry) lose_sight();
  }
}

/// Lost, but odometry was there all the time and the vehicle has driven on: it sees new surroundings. A vehicle that
/// was lifted and put down elsewhere has not driven.
bool TrackingState::sees_new_ground(const ScanResult& scan) const {
  return fix_ == Fix::kLost && !was_blind_ && scan.with_odometry && !scan.sparse &&
         scan.utime - last_fit_ > kNewGround && since_fitted_m_ > kNewGroundPath;
}

void TrackingState::trust(std::int64_t utime) {
  last_fit_ = utime;
  since_fitted_m_ = uncertainty_ = 0;
  blind_ = was_blind_ = false;
}

void TrackingState::lose_sight() {
  blind_ = was_blind_ = true;
}

void TrackingState::go_blind(Counters& counters) {
  if (fix_ != Fix::kLost) counters.add("lost.blind");
  fix_ = Fix::kLost;
  lose_sight();
}

void TrackingState::relocate() {
  drift_.setZero();
  fix_ = Fix::kTentative;
  fitting_ = 0;
  blind_ = false;
}

void TrackingState::start_lost(double uncertainty) {
  fix_ = Fix::kLost;
  lose_sight();
  uncertainty_ = uncertainty;
}

void TrackingState::resume(std::int64_t utime, double path) {
  fix_ = Fix::kTracking;
  blind_ = was_blind_ = false;
  last_fit_ = utime;
  since_fitted_m_ = path;
  uncertainty_ = kGuidedUncertainty * path;
  drift_.topLeftCorner<3, 3>().diagonal().setConstant(uncertainty_ * uncertainty_);
  drift_.bottomRightCorner<3, 3>().diagonal().setConstant(kGuidedTurn * kGuidedTurn * path);
}

}  // namespace curbstone::mapper::tracking
