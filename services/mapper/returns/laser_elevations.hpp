#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::returns {

/// Finds lasers whose elevation is not the one that the driver takes for it: a wrong file of angles, another device's,
/// a laser out of adjustment. Such a laser lays a false edge along the road wherever it looks.
///
/// Lasers above each other draw the ground's profile in each direction. Where the middle one of three lies above or
/// below the line through the other two, and as much in most directions, it is not the ground but an elevation: that of
/// one of the three, and the triples beside tell of which. Nothing is asked of the pose, nor of how the LiDAR is
/// mounted. A laser is wrong once kLooks revolutions in a row say the same, until as many say that it is right. Lasers
/// that see no ground are not judged, and one at a time is found. Where the ground is in sight in fewer than a third of
/// all directions, it takes a vehicle that moves: what stands about one that does not looks the same for as long as it
/// stands.
///
/// A function of the scans alone. Pure; one thread. Counters: faults.laser (lasers that were found wrong),
/// withheld.laser (their points).
class LaserElevations {
 public:
  static constexpr int kLooks = 40;            ///< revolutions
  static constexpr double kStep = 0.2;         ///< m
  static constexpr double kWrong = 0.0036;     ///< rad, 0.2 deg
  static constexpr double kRight = 0.0020;     ///< rad
  static constexpr std::size_t kLasers = 128;  ///< rings beyond are not judged

  /// What one revolution says. `moved`: the vehicle has, since that was last so, by kStep m or more.
  void look(const scan::Scan& scan, bool moved);
  /// Takes the points of the wrong lasers out.
  void withhold(scan::Scan& scan);
  [[nodiscard]] bool any_wrong() const { return num_wrong_ > 0; }
  [[nodiscard]] bool is_wrong(std::size_t ring) const { return ring < kLasers && lasers_[ring].wrong; }
  /// rad that the laser's points are too high by.
  [[nodiscard]] double error(std::size_t ring) const { return lasers_[ring].error; }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Laser {
    double error = 0;  // rad, mean of the looks in a row
    int looks = 0;     // that say so,
    int right = 0;     // or that it is right
    bool wrong = false;
  };
  void judge(std::size_t ring, double error);

  std::array<Laser, kLasers> lasers_{};
  int num_wrong_ = 0;
  Counters counters_;
};

}  // namespace curbstone::mapper::returns
