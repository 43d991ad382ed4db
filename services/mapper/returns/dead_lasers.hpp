#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::returns {

/// Finds lasers that returned and return nothing any more, not once in kSilent revolutions. In the open the upper
/// lasers may see nothing for long; so a laser is dead only if one above and one below it return meanwhile, over
/// kBetween looks of a moving vehicle, or if its returns, a quarter or more of the best laser's, ended from one
/// revolution to the next, as no surroundings do. Revolutions of which packets are missing are not looked at. It is
/// dead until it has returned as often again. Status only. A function of the calls. Pure; one thread. Counters:
/// faults.lidar.dead_laser (lasers that became dead).
class DeadLasers {
 public:
  static constexpr int kSteady = 100;     ///< revolutions with kMin returns or more
  static constexpr int kSilent = 60;      ///< revolutions in a row
  static constexpr int kBetween = 50;     ///< looks on the move
  static constexpr int kBack = 20;        ///< revolutions
  static constexpr int kMin = 20;         ///< returns
  static constexpr int kShareOfBest = 4;  ///< a quarter

  /// To be called for each revolution. `moved`: the vehicle has moved by 0.2 m or so since `moved` was last true.
  void check(const scan::Scan& scan, bool moved);
  /// Their rings.
  [[nodiscard]] std::vector<int> dead() const;
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Laser {
    int returns = 0;      // of the last complete revolution
    int steady = 0;       // revolutions, up to kSteady
    int silent = 0;       // revolutions in a row
    int between = 0;      // of these, on the move and with a living laser above and below
    int back = 0;         // revolutions with returns while dead
    bool abrupt = false;  // ended from one revolution to the next
    bool dead = false;
    std::int64_t since = 0;  // us
  };
  void judge(Laser& laser, int returns, int best, bool moved_between, std::int64_t utime, bool follows);

  std::array<Laser, 256> lasers_{};
  double packets_ = 0;       // of a complete revolution
  std::int64_t newest_ = 0;  // us, start of the last complete revolution
  Counters counters_;
};

}  // namespace curbstone::mapper::returns
