#pragma once

#include <cstdint>

#include "common/bus/counters.hpp"
#include "services/mapper/registration/registration.hpp"

namespace curbstone::mapper::tracking {

/// How far the pose can be trusted.
enum class Fix {
  kTracking,   ///< scans fit the map
  kTentative,  ///< relocalised; more scans must fit before the map takes any
  kLost,       ///< the pose is only a guess
};

/// Computes Fix and the possible error of the pose from which scans fitted and how far the vehicle drove since. A
/// value, pure.
///
/// Counters: found, lost.blind, lost.refused, began_anew.
class TrackingState {
 public:
  /// The result of one scan.
  struct ScanResult {
    std::int64_t utime = 0;                                            ///< us, end of the scan
    double stride = 0;                                                 ///< s since the end of the previous scan
    double distance = 0;                                               ///< m since then, as predicted
    bool with_odometry = false;                                        ///< odometry made that prediction
    bool fits = false;                                                 ///< the scan fits the map
    registration::Matrix6 covariance = registration::Matrix6::Zero();  ///< of the prediction, in base_link axes
    bool sparse = false;  ///< too few points to fit; that contradicts nothing
  };

  [[nodiscard]] Fix fix() const { return fix_; }
  [[nodiscard]] bool tracking() const { return fix_ == Fix::kTracking; }
  /// Lost, and odometry does not bound the error either: a registration that begins from a guess may fit anywhere.
  [[nodiscard]] bool unbounded() const { return fix_ == Fix::kLost && blind_; }
  /// Lost, and for some of the time since the last fit no sensor measured the motion: the pose is not dead reckoning.
  [[nodiscard]] bool was_unobserved() const { return fix_ == Fix::kLost && was_blind_; }
  /// Possible error of the pose since the last scan that fitted, m.
  [[nodiscard]] double uncertainty() const { return uncertainty_; }
  /// End of the last scan that fitted, us.
  [[nodiscard]] std::int64_t last_fit() const { return last_fit_; }
  [[nodiscard]] int refused_in_a_row() const { return refused_in_a_row_; }
  /// Covariance of the pose at the end of the last scan if that scan was refused, in base_link axes; else zero.
  [[nodiscard]] const registration::Matrix6& drift() const { return drift_; }

  /// The first scan of a drive, or after a jump of the clock, ended at `utime`, us.
  void start(std::int64_t utime) { last_fit_ = utime; }
  /// Covariance of the pose at the end of the next scan if that scan does not fit, in base_link axes.
  [[nodiscard]] registration::Matrix6 covariance_without(const ScanResult& scan) const;
  /// Takes the next scan. True if the registration map should begin anew with it.
  [[nodiscard]] bool judge(const ScanResult& scan, Counters& counters);
  /// No sensor measured the motion: lost.
  void go_blind(Counters& counters);

  /// The vehicle was relocalised: tentative.
  void relocate();
  /// The vehicle is within `uncertainty` m of the start pose in a loaded map: lost until relocate().
  void start_lost(double uncertainty);
  /// The vehicle is tracked at `utime`, us, after `path` m by odometry alone since the last scan that fitted.
  void resume(std::int64_t utime, double path);
  void forget_drift() { drift_.setZero(); }

 private:
  [[nodiscard]] double uncertainty_after(const ScanResult& scan) const;
  void take_fit(const ScanResult& scan, Counters& counters);
  void take_refusal(const ScanResult& scan, Counters& counters);
  [[nodiscard]] bool sees_new_ground(const ScanResult& scan) const;
  void lose_sight();
  void trust(std::int64_t utime);

  Fix fix_ = Fix::kTracking;
  int fitting_ = 0;            // scans in a row, while tentative
  bool blind_ = false;         // lost, and odometry does not say how far off
  bool was_blind_ = false;     // blind at some time since the last scan that fitted
  double since_fitted_m_ = 0;  // predicted path since the last scan that fitted
  double uncertainty_ = 0;     // m, possible error of the pose since then
  std::int64_t last_fit_ = 0;  // us, the end of the last scan that fitted
  int refused_in_a_row_ = 0;
  registration::Matrix6 drift_ = registration::Matrix6::Zero();
};

}  // namespace curbstone::mapper::tracking
