#include "services/mapper/tracking/pose_trust.hpp"

namespace curbstone::mapper::tracking {
namespace {

constexpr std::int64_t kPatience = 1'000'000;   // us without a fit, after which the pose is lost
constexpr int kConfirmed = 10;                  // scans in a row that must fit before a pose is trusted again
constexpr double kDoubtSpeed = 3.0;             // m/s, growth of the doubt while lost or without odometry,
constexpr double kGuidedDoubt = 0.05;           // and m per metre with odometry
constexpr double kGuidedTurn = 0.005;           // rad, error of odometry's attitude after a metre
constexpr double kMaxUncertainty = 0.5;         // m up to which odometry alone continues the pose over sparse scans
constexpr std::int64_t kNewGround = 6'000'000;  // us without a fit, by when the whole map was searched, and
constexpr double kNewGroundPath = 10.0;         // m by odometry without a fit: the surroundings are new

}  // namespace

bool PoseTrust::judge(const Evidence& scan, Counters& counters) {
  since_fitted_m_ += scan.went;
  doubt_ = doubt_after(scan);
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

double PoseTrust::doubt_after(const Evidence& scan) const {
  const bool guided = scan.with_odometry && fix_ != Fix::kLost;
  return doubt_ + (guided ? kGuidedDoubt * scan.went : kDoubtSpeed * scan.stride);
}

registration::Matrix6 PoseTrust::covariance_without(const Evidence& scan) const {
  registration::Matrix6 covariance = drift_ + scan.covariance;
  const double doubt = doubt_after(scan);
  covariance.topLeftCorner<3, 3>().diagonal().array() += doubt * doubt;
  return covariance;
}

void PoseTrust::take_fit(const Evidence& scan, Counters& counters) {
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

void PoseTrust::take_refusal(const Evidence& scan, Counters& counters) {
  if (!scan.sparse) ++refused_in_a_row_;
  drift_ += scan.covariance;
  if (fix_ == Fix::kTentative) fix_ = Fix::kLost;
  if (scan.sparse && scan.with_odometry && doubt_ < kMaxUncertainty) return;
  if (fix_ == Fix::kTracking && scan.utime - fitted_ > kPatience) {
    counters.add("lost.refused");
    fix_ = Fix::kLost;
    blind_ = false;
    if (!scan.with_odometry) lose_sight();
  }
}

/// Lost, but odometry was there all the time and the vehicle has driven on: it sees new surroundings. A vehicle that
/// was lifted and put down elsewhere has not driven.
bool PoseTrust::sees_new_ground(const Evidence& scan) const {
  return fix_ == Fix::kLost && !was_blind_ && scan.with_odometry && !scan.sparse && scan.utime - fitted_ > kNewGround &&
         since_fitted_m_ > kNewGroundPath;
}

void PoseTrust::trust(std::int64_t utime) {
  fitted_ = utime;
  since_fitted_m_ = doubt_ = 0;
  blind_ = was_blind_ = false;
}

void PoseTrust::lose_sight() {
  blind_ = was_blind_ = true;
}

void PoseTrust::go_blind(Counters& counters) {
  if (fix_ != Fix::kLost) counters.add("lost.blind");
  fix_ = Fix::kLost;
  lose_sight();
}

void PoseTrust::relocate() {
  drift_.setZero();
  fix_ = Fix::kTentative;
  fitting_ = 0;
  blind_ = false;
}

void PoseTrust::begin_lost(double doubt) {
  fix_ = Fix::kLost;
  lose_sight();
  doubt_ = doubt;
}

void PoseTrust::resume(std::int64_t utime, double path) {
  fix_ = Fix::kTracking;
  blind_ = was_blind_ = false;
  fitted_ = utime;
  since_fitted_m_ = path;
  doubt_ = kGuidedDoubt * path;
  drift_.topLeftCorner<3, 3>().diagonal().setConstant(doubt_ * doubt_);
  drift_.bottomRightCorner<3, 3>().diagonal().setConstant(kGuidedTurn * kGuidedTurn * path);
}

}  // namespace curbstone::mapper::tracking
