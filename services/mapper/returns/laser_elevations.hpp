#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::returns {

/// Finds lasers whose elevation differs from the driver's table: a wrong file of angles, another device's file, a laser
/// out of adjustment. Such a laser draws a false edge along the road.
///
/// Lasers above each other draw the ground's profile in each direction. If the middle one of three lies above or below
/// the line through the other two, by the same angle in most directions, an elevation is wrong, not the ground uneven;
/// the neighbouring triples show which of the three lasers it is. The check needs neither the pose nor the mounting of
/// the LiDAR. A laser is wrong once kLooks revolutions in a row say the same, until as many say that it is right.
/// Lasers that do not see the ground are not judged, and only one laser is found at a time. If the ground is visible in
/// fewer than a third of all directions, only revolutions of a moving vehicle count: the surroundings of a standing one
/// look the same throughout.
///
/// A function of the scans alone. Pure; one thread. Counters: faults.laser (lasers that were found wrong),
/// withheld.laser (their points).
class LaserElevations {
 public:
  static constexpr int kLooks = 40;            ///< revolutions
  static constexpr double kStep = 0.2;         ///< m
  static constexpr double kWrong = 0.0036;     ///< rad, 0.2 deg
  static constexpr double kRight = 0.0020;     ///< rad
  static constexpr std::size_t kLasers = 128;  ///< rings above are not judged

  /// Judges one revolution. `moved`: the vehicle has moved by kStep m or more since `moved` was last true.
  void check(const scan::Scan& scan, bool moved);
  /// Removes the points of the wrong lasers.
  void withhold(scan::Scan& scan);
  [[nodiscard]] bool any_wrong() const { return num_wrong_ > 0; }
  [[nodiscard]] bool is_wrong(std::size_t ring) const { return ring < kLasers && lasers_[ring].wrong; }
  /// rad by which the laser's points are too high.
  [[nodiscard]] double error(std::size_t ring) const { return lasers_[ring].error; }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Laser {
    double error = 0;  // rad, mean of the consistent looks in a row
    int looks = 0;     // in a row that show this error,
    int right = 0;     // or no error
    bool wrong = false;
  };
  void judge(std::size_t ring, double error);

  std::array<Laser, kLasers> lasers_{};
  int num_wrong_ = 0;
  Counters counters_;
};

}  // namespace curbstone::mapper::returns
