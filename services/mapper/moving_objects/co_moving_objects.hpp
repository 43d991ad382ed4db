#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/config/vehicle.hpp"
#include "services/mapper/moving_objects/surround_view.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::moving_objects {

/// Finds what drives along with the vehicle: a bus in the next lane, a lorry on either side, a trailer. Such an object
/// stands still in base_link. Registration would follow it instead of the street, and the free-space test cannot remove
/// it, as it hides the same directions all the time.
///
/// A direction is evidence if its range is the same as a second or more before, while the world moved by odometry: then
/// either the earlier revolution saw through the place where the object is now, or this one sees through the place
/// where it was. The side of a bus is evidence at its ends, all of it in a bend. A wall along the street has the same
/// range, too, but no place of it was seen through. From evidence over kMinEvidence m the object is all that is
/// connected to it and keeps its range. It is forgotten after kForgotten m without evidence.
///
/// Where hardly any range beyond 12 m changes, odometry moves and the vehicle does not (spinning wheels), and nothing
/// is evidence. Objects farther away are not left out: many other things are in sight beside them.
///
/// Pure; one thread; a function of the calls. Cost: one look each kLook; without a co-moving object nothing else.
/// Counters: co_moving (times that one was found), withheld.co_moving (points).
class CoMovingObjects {
 public:
  static constexpr std::int64_t kLook = 250'000;           ///< us
  static constexpr std::int64_t kMinInterval = 450'000;    ///< us, from the earlier revolution of a comparison
  static constexpr std::int64_t kMaxInterval = 3'000'000;  ///< us
  static constexpr double kMinMotion = 1.5;                ///< m, of the vehicle between the two
  static constexpr double kMinTurn = 0.09;                 ///< rad, or this
  static constexpr double kMinEvidence = 1.0;              ///< m
  static constexpr double kForgotten = 15;                 ///< m, of the vehicle's way
  static constexpr int kFaultFrom = 60;                    ///< deg of the view that are hidden,
  static constexpr std::int64_t kLasting = 10'000'000;     ///< us, for so long: longer than overtaking takes

  explicit CoMovingObjects(const VehicleConfig& vehicle);

  /// Takes the next revolution, in lidar. Returns it without the returns of co-moving objects, or nothing if there are
  /// none.
  [[nodiscard]] std::optional<scan::Scan> without(const scan::Scan& scan, const scan::OdometryHistory& odometry);
  /// deg of the view that co-moving objects take.
  [[nodiscard]] int hidden() const { return hidden_; }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  static constexpr int kBins = SurroundView::kBins;
  /// What is known of a direction.
  struct Direction {
    int steady = 0;    // looks in a row with the same range
    int evidence = 0;  // looks with evidence, less those without
    double until = 0;  // m of the vehicle's way, until which it belongs to a co-moving object
    float range = 0;   // m, of that object
    int missed = 0;    // looks in a row without that range
  };

  void look(const scan::Scan& scan, const scan::OdometryHistory& odometry);
  void compare(const SurroundView& now, const std::vector<const SurroundView*>& earlier);
  void follow(const SurroundView& now);
  void connect(const SurroundView& now);
  void take_object(const SurroundView& now, int first, int last);
  void forget();

  SurroundView::Mounting mounting_;
  std::deque<SurroundView> views_;  // of the last kMaxInterval, in order
  std::array<Direction, kBins> directions_{};
  double way_ = 0;  // m driven
  std::int64_t looked_ = 0;
  int hidden_ = 0;
  std::int64_t hidden_since_ = 0;  // us: kFaultFrom and more
  Counters counters_;
};

}  // namespace curbstone::mapper::moving_objects
