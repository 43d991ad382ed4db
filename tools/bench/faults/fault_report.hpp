#pragma once

#include <optional>
#include <string>
#include <vector>

namespace curbstone::bench::faults {

/// What a fault did to a drive and its map.
struct FaultRow {
  std::string fault;
  int cells_differ = 0;           ///< in class, from the replay of an undisturbed drive of the same length
  int poses_missing = 0;          ///< of that replay's revolutions
  std::optional<double> back_s;   ///< until all ran and named no fault; empty: not before the end of the drive
  std::vector<std::string> said;  ///< "service: fault"
  bool ended_cleanly = false;     ///< all processes, when asked to
  std::string map;                ///< "ok", or what is wrong with the file
  double emulator_late_s = 0;     ///< over 0.1 s the machine was busy with other things
};

/// The replay that the rows are compared with.
struct Undisturbed {
  double seconds = 0;
  int cells = 0;  ///< of known class
  int poses = 0;
};

struct FaultReport {
  std::vector<Undisturbed> undisturbed;
  std::vector<FaultRow> rows;
};

[[nodiscard]] std::vector<std::string> table_lines(const FaultReport& report);
/// As JSON. Throws std::runtime_error where the file cannot be written.
void write_report(const FaultReport& report, const std::string& file);

}  // namespace curbstone::bench::faults
