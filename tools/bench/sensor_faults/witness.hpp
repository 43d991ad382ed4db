#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tools/replay/vehicle.hpp"

namespace curbstone::bench::sensor_faults {

/// A fault or a counter that a service reported.
struct Said {
  std::string service;
  std::string words;       ///< of the fault, as it was first reported, or the counter's name
  double at = 0;           ///< s of the drive, when it was first reported
  double last = 0;         ///< s of the drive, when it was last reported
  std::int64_t value = 0;  ///< of a counter, at last
};

/// Notes what the services report in the course of a drive, as an operator sees it in SERVICE_STATUS. Faults that
/// differ only in their numbers are one. Of the counters only those of losses and refusals are noted, when they leave
/// 0.
class Witness {
 public:
  /// `t`: s of the drive, increasing.
  void look(double t, const std::vector<replay::Stage>& stages);

  /// What this drive said and an undisturbed one did not, in the order in which it was first reported: faults from
  /// `from` s on that were not reported there, or are reported more than 2 s after that one's last report; counters
  /// that went beyond the undisturbed drive's.
  [[nodiscard]] std::vector<Said> new_faults(const Witness& undisturbed, double from) const;
  [[nodiscard]] std::vector<Said> new_counters(const Witness& undisturbed, double from) const;

 private:
  using Key = std::pair<std::string, std::string>;  // service, words without numbers
  struct Noted {
    Said said;
    std::vector<std::pair<double, std::int64_t>> seen;  // s, value: of each look with a report, or with a new value
  };

  std::map<Key, Noted> faults_, counters_;
};

}  // namespace curbstone::bench::sensor_faults
