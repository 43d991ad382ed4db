#pragma once

#include <limits>
#include <vector>

namespace curbstone::simulate::motion {

/// Speed along the route over time as a series of smooth ramps: starts at rest, drives, stops in between, drives on.
/// The acceleration is continuous. With `manoeuvres` the vehicle does one at each stop, as one that drives on its own
/// tracks or differential drive does: it backs up and drives on; turns once on the spot; turns about, drives the next
/// leg backwards, and turns back.
class SpeedProfile {
 public:
  struct Options {
    double speed = 3.0;         ///< m/s
    double standstill = 4.0;    ///< s at the start, for the levelling of the IMU
    double acceleration = 0.9;  ///< m/s^2, at most
    double drive = 26.0;        ///< s from a start to the next braking; longer if accelerating takes longer
    double stop = 2.5;          ///< s, duration of a stop in between
    double distance = std::numeric_limits<double>::infinity();  ///< m after which it stops for good
    bool manoeuvres = false;                                    ///< at the stops in between
  };
  SpeedProfile(const Options& options, double seconds);

  [[nodiscard]] double distance(double t) const;           ///< m
  [[nodiscard]] double speed(double t) const;              ///< m/s, negative where it backs up
  [[nodiscard]] double acceleration(double t) const;       ///< m/s^2
  [[nodiscard]] double turned(double t) const;             ///< rad to the left of the route's direction
  [[nodiscard]] double cruise() const { return cruise_; }  ///< m/s
  [[nodiscard]] double end() const { return end_; }        ///< s, when it stops for good

 private:
  struct Ramp {  // from v0 to v1 within `duration`, then v1 until the next
    double start, duration, v0, v1, distance;
  };
  struct Turn {  // on the spot, by `angle` rad within `duration`
    double start, duration, angle;
  };
  [[nodiscard]] const Ramp& ramp_at(double t) const;
  /// What it does at a stop from t on, `distance` m along the route; moves both on to when the next leg begins.
  void back_up(double& t, double& distance, const Options& options);
  void turn(double& t, double angle, const Options& options);

  std::vector<Ramp> ramps_;
  std::vector<Turn> turns_;
  double cruise_;
  double end_ = std::numeric_limits<double>::infinity();
};

}  // namespace curbstone::simulate::motion
