#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::returns {

/// Finds directions from which nothing comes back any more: mud or a leaf on the window, something that hangs before
/// it. A sector is blind that returned in kSteady revolutions of a vehicle on the move, and then in kBlind in a row
/// next to nothing from beyond kNear, though most others did; until it returns as much again. One that never returned
/// is the vehicle's own: nothing is said of it. Status only. A function of the calls. Pure; one thread. Counters:
/// faults.blind_sector (sectors that became so).
class BlindSectors {
 public:
  static constexpr int kSectors = 36;
  static constexpr int kSteady = 100;   ///< looks
  static constexpr int kBlind = 50;     ///< looks
  static constexpr float kNear = 0.8F;  ///< m

  /// Once for every 0.2 m or so that the vehicle moves.
  void look(const scan::Scan& scan);
  /// 10 deg each, by their middle: deg to the left of the LiDAR's x.
  [[nodiscard]] std::vector<int> blind() const;
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Sector {
    int steady = 0;  // looks, up to kSteady
    int empty = 0;   // in a row, up to kBlind
  };
  std::array<Sector, kSectors> sectors_{};
  Counters counters_;
};

}  // namespace curbstone::mapper::returns
