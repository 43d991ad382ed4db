#pragma once

#include <string>
#include <vector>

#include "tools/bench/sensor_faults/catalogue/fault.hpp"
#include "tools/bench/sensor_faults/trial.hpp"

namespace curbstone::bench::sensor_faults {

constexpr double kGoodF1 = 0.9;  ///< of the curbs at 0.24 m; a map with less is called bad

/// A fault and what came of it.
struct Row {
  std::string sensor, name, words;
  double from = 0;  ///< s of the drive
  std::optional<MapFigures> map{};
  std::string failure{};         ///< why there are no figures
  std::vector<Said> faults{};    ///< that services reported because of it, in order
  std::vector<Said> counters{};  ///< of losses and refusals that counted because of it, in order

  [[nodiscard]] bool is_bad() const { return !map || map->f1 < kGoodF1; }
  /// "good" or "bad", with "named" if a service reported a fault, or "counted" if only counters say something. A bad
  /// map of which nobody says anything, the worst outcome, is "BAD, UNNAMED"; one with counters only "BAD, counted".
  [[nodiscard]] std::string verdict() const;
};

/// The row of a fault: what its replay said beyond the undisturbed one. Of a drive without a fault, with an empty
/// `undisturbed`, all that was said.
[[nodiscard]] Row row_of(const catalogue::Fault& fault, const Outcome& outcome, const Outcome& undisturbed);

[[nodiscard]] std::vector<std::string> table_lines(const std::vector<Row>& rows);
/// Writes JSON: {"rows": [...], "good_f1", "counts": {"faults", "bad_named", "bad_unnamed"}}. The first row is the
/// undisturbed drive. Throws
/// std::runtime_error if the file cannot be written.
void write_report(const std::vector<Row>& rows, const std::string& file);

}  // namespace curbstone::bench::sensor_faults
