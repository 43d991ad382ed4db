#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::returns {

/// Finds directions without returns: mud or a leaf on the window, or something that hangs in front of it. A sector is
/// blind if it had returns in kSteady revolutions of a moving vehicle, and then hardly any from beyond kNear in kBlind
/// in a row, while most others had; it is blind until it has had returns as often again. A sector that never had
/// returns faces the vehicle itself and is not reported. Status only. A function of the calls. Pure; one thread.
/// Counters: faults.blind_sector (sectors that became blind).
class BlindSectors {
 public:
  static constexpr int kSectors = 36;
  static constexpr int kSteady = 20;    ///< looks
  static constexpr int kBlind = 50;     ///< looks
  static constexpr float kNear = 0.8F;  ///< m

  /// To be called once per 0.2 m or so of motion.
  void check(const scan::Scan& scan);
  /// Blind sectors of 10 deg each, by their centre: deg to the left of the LiDAR's x.
  [[nodiscard]] std::vector<int> blind() const;
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  /// The blind arcs in words.
  [[nodiscard]] std::vector<std::string> arcs() const;

  struct Sector {
    int steady = 0;  // looks, up to kSteady
    int empty = 0;   // in a row, up to kBlind
  };
  std::array<Sector, kSectors> sectors_{};
  Counters counters_;
};

}  // namespace curbstone::mapper::returns
