#pragma once

#include <optional>
#include <string>
#include <vector>

namespace curbstone::bench::faults {

constexpr double kLate = 0.1;  ///< s, one revolution: an emulator later than this ran on a busy machine

/// Why a row need not keep a limit, in words.
struct Excuse {
  enum class Covers { kNothing, kTime, kAll };
  Covers covers = Covers::kNothing;
  std::string why{};
};

/// The effect of a fault on a drive and its map.
struct FaultRow {
  std::string fault;
  /// Compared with the replay of an undisturbed drive of the same length: cells of a different class, and revolutions
  /// of that replay without a pose. Empty: that drive or this one was spoiled.
  std::optional<int> cells_differ{}, poses_missing{};
  std::optional<double> back_s{};   ///< until all ran without a fault; empty: not before the drive's end
  std::vector<std::string> said{};  ///< reported faults, "service: fault"
  bool ended_cleanly = false;       ///< all processes, on request
  std::string map;                  ///< "ok", or what is wrong with the file
  double emulator_late_s = 0;
  double seconds = 0;           ///< of driving
  bool is_undisturbed = false;  ///< there was no fault
  Excuse excuse{};
  int drives = 1;  ///< number of drives; the last one is reported, the earlier ones were spoiled

  /// Whether the result says nothing about the fault, because the machine was busy.
  [[nodiscard]] bool is_spoiled() const { return emulator_late_s > kLate; }
};

/// An undisturbed drive and its replay, with which the rows are compared.
struct Undisturbed {
  double seconds = 0;
  int cells = 0;  ///< of known class
  int poses = 0;
  double emulator_late_s = 0;
  int revolutions_lost = 0;         ///< between the replay's first and last pose
  int live_cells_differ = 0;        ///< in class, between the map of the live drive and that of the replay
  int live_poses_missing = 0;       ///< in the map of the live drive
  std::vector<std::string> said{};  ///< "service: fault"

  /// Whether the machine was busy, so that a comparison says nothing.
  [[nodiscard]] bool is_spoiled() const { return emulator_late_s > kLate || revolutions_lost > 0; }
};

struct FaultReport {
  std::vector<Undisturbed> undisturbed;  ///< including spoiled ones
  std::vector<FaultRow> rows;
};

[[nodiscard]] std::vector<std::string> table_lines(const FaultReport& report);
/// One line for people: figures of the drive, and whether rows are compared with it.
[[nodiscard]] std::string to_line(const Undisturbed& drive);
/// Writes JSON. Throws std::runtime_error if the file cannot be written.
void write_report(const FaultReport& report, const std::string& file);

}  // namespace curbstone::bench::faults
