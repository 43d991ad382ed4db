#pragma once

#include <cstdint>

#include "common/bus/counters.hpp"
#include "services/mapper/registration/registration.hpp"

namespace curbstone::mapper::tracking {

/// How far the pose can be trusted.
enum class Fix {
  kTracking,   ///< scan after scan fits the map
  kTentative,  ///< found again; a few more must fit before the map takes anything
  kLost,       ///< only a guess
};

/// Keeps Fix, and how far off the pose may be, from which scans fitted and what was driven meanwhile. A value, pure.
///
/// Counts: found, lost.blind, lost.refused, began_anew.
class PoseTrust {
 public:
  /// What one scan tells.
  struct Evidence {
    std::int64_t utime = 0;                                            ///< us, its end
    double stride = 0;                                                 ///< s since the end of the scan before
    double went = 0;                                                   ///< m since then, as expected
    bool with_odometry = false;                                        ///< of which `went` is
    bool fits = false;                                                 ///< the map
    registration::Matrix6 covariance = registration::Matrix6::Zero();  ///< of what was expected, in base_link axes
    bool sparse = false;  ///< too few points to fit anything, which contradicts nothing
  };

  [[nodiscard]] Fix fix() const { return fix_; }
  [[nodiscard]] bool tracking() const { return fix_ == Fix::kTracking; }
  /// Lost, and not even odometry says how far off: a registration from a mere guess fits somewhere.
  [[nodiscard]] bool groundless() const { return fix_ == Fix::kLost && blind_; }
  /// Lost, and for some of the time since the last fit nothing told how the vehicle moved: no measurement leads here.
  [[nodiscard]] bool adrift() const { return fix_ == Fix::kLost && was_blind_; }
  /// How far off the pose may be, m, since the last scan that fitted...
  [[nodiscard]] double doubt() const { return doubt_; }
  /// ...which ended then; us.
  [[nodiscard]] std::int64_t fitted() const { return fitted_; }
  [[nodiscard]] int refused_in_a_row() const { return refused_in_a_row_; }
  /// Covariance of the pose at the end of the last scan if that was refused, in base_link axes; else zero.
  [[nodiscard]] const registration::Matrix6& drift() const { return drift_; }

  /// The first scan of a drive, or of a new clock, ended at `utime`.
  void start(std::int64_t utime) { fitted_ = utime; }
  /// Covariance of the pose at the end of the next scan if that does not fit, in base_link axes.
  [[nodiscard]] registration::Matrix6 covariance_without(const Evidence& scan) const;
  /// Takes the next scan. True where the map for registration is to begin anew with it.
  [[nodiscard]] bool judge(const Evidence& scan, Counters& counters);
  /// No sensor tells how the vehicle moved.
  void go_blind(Counters& counters);

  /// The vehicle was found elsewhere: tentative.
  void relocate();
  /// It is somewhere within `doubt` m in a map that is known: lost until relocate().
  void begin_lost(double doubt);
  /// By odometry alone it went `path` m since it was last found at `utime`, and is tracked.
  void resume(std::int64_t utime, double path);
  void forget_drift() { drift_.setZero(); }

 private:
  [[nodiscard]] double doubt_after(const Evidence& scan) const;
  void take_fit(const Evidence& scan, Counters& counters);
  void take_refusal(const Evidence& scan, Counters& counters);
  [[nodiscard]] bool sees_new_ground(const Evidence& scan) const;
  void lose_sight();
  void trust(std::int64_t utime);

  Fix fix_ = Fix::kTracking;
  int fitting_ = 0;            // scans in a row, while tentative
  bool blind_ = false;         // lost, and not even odometry says how far
  bool was_blind_ = false;     // at some time since the last scan that fitted
  double since_fitted_m_ = 0;  // moved by odometry since the last one that fitted
  double doubt_ = 0;           // m, that the pose may be off by since then
  std::int64_t fitted_ = 0;    // us, the end of the last scan that fitted
  int refused_in_a_row_ = 0;
  registration::Matrix6 drift_ = registration::Matrix6::Zero();
};

}  // namespace curbstone::mapper::tracking
