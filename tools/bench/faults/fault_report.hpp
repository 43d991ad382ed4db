#pragma once

#include <optional>
#include <string>
#include <vector>

namespace curbstone::bench::faults {

constexpr double kLate = 0.1;  ///< s, a revolution: an emulator that is later had a machine busy with other things

/// What a fault did to a drive and its map.
struct FaultRow {
  std::string fault;
  /// In class, from the replay of an undisturbed drive of the same length; and of that replay's revolutions. Empty:
  /// that drive was spoiled, or this one.
  std::optional<int> cells_differ{}, poses_missing{};
  std::optional<double> back_s{};   ///< until all ran and named no fault; empty: not before the end of the drive
  std::vector<std::string> said{};  ///< "service: fault"
  bool ended_cleanly = false;       ///< all processes, when asked to
  std::string map;                  ///< "ok", or what is wrong with the file
  double emulator_late_s = 0;
  int drives = 1;  ///< of which the last is reported: those before were spoiled

  /// What it came to says nothing of the fault.
  [[nodiscard]] bool is_spoiled() const { return emulator_late_s > kLate; }
};

/// The replay that the rows are compared with.
struct Undisturbed {
  double seconds = 0;
  int cells = 0;  ///< of known class
  int poses = 0;
  double emulator_late_s = 0;
  int revolutions_lost = 0;         ///< between its first and its last pose
  int live_cells_differ = 0;        ///< in class, of the map of the drive itself
  int live_poses_missing = 0;       ///< in that map
  std::vector<std::string> said{};  ///< "service: fault"

  /// The machine was busy with other things: what differs from it says nothing.
  [[nodiscard]] bool is_spoiled() const { return emulator_late_s > kLate || revolutions_lost > 0; }
};

struct FaultReport {
  std::vector<Undisturbed> undisturbed;  ///< spoiled ones too
  std::vector<FaultRow> rows;
};

[[nodiscard]] std::vector<std::string> table_lines(const FaultReport& report);
/// One line for people: what the drive was like, and whether rows are compared with it.
[[nodiscard]] std::string to_line(const Undisturbed& drive);
/// As JSON. Throws std::runtime_error where the file cannot be written.
void write_report(const FaultReport& report, const std::string& file);

}  // namespace curbstone::bench::faults
