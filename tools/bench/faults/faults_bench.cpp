#include "tools/bench/faults/faults_bench.hpp"

#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/config/command_line.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "services/semantic_map/tile/map_types.hpp"
#include "tools/bench/faults/fault_limits.hpp"
#include "tools/bench/faults/fault_report.hpp"
#include "tools/bench/faults/fault_rows.hpp"
#include "tools/evaluate/map_difference.hpp"

namespace curbstone::bench::faults {

namespace {

namespace fs = std::filesystem;
using semantic_map::store::MapReader;
using semantic_map::tile::CellClass;

constexpr int kAttempts = 2;  // per drive, if the machine was busy

struct FaultsBenchOptions {
  std::string procman_config = "procman/demo.cfg";
  std::string config = "config/ugv.yaml";
  std::string folder;
  std::string only, json;
  double seconds = 0;  // 0: as given by the row
  bool list = false;
  bool check = false;
};

evaluate::StoredMap read_map(const std::string& file) {
  const MapReader reader(file);
  return {reader.tiles(), reader.curbs(), reader.trajectory()};
}

int known_cells(const evaluate::StoredMap& map) {
  std::int64_t known = 0;
  for (const auto& tile : map.tiles)
    known += std::ranges::count_if(tile.cell_class, [](CellClass cell) { return cell != CellClass::kUnknown; });
  return static_cast<int>(known);
}

/// Number of revolutions between the first and the last pose that have no pose.
int revolutions_lost(const evaluate::StoredMap& map) {
  if (map.trajectory.empty()) return 0;
  const auto [first, last] = std::ranges::minmax(map.trajectory, {}, &semantic_map::tile::TrajectoryPose::revolution);
  return last.revolution - first.revolution + 1 - static_cast<int>(map.trajectory.size());
}

/// The rows selected by "part|other part". A part that equals a row's name selects only that row.
std::vector<Fault> chosen(const std::vector<Fault>& faults, const std::string& parts) {
  if (parts.empty()) return faults;
  std::vector<Fault> found;
  for (const Fault& fault : faults) {
    bool is_meant = false;
    std::istringstream list(parts);
    for (std::string part; std::getline(list, part, '|');) {
      const bool is_name = std::ranges::find(faults, part, &Fault::name) != faults.end();
      is_meant = is_meant || (is_name ? fault.name == part : fault.name.find(part) != std::string::npos);
    }
    if (is_meant) found.push_back(fault);
  }
  return found;
}

/// Runs the drives with faults, and the undisturbed drives that they are compared with.
class FaultsBench {
 public:
  explicit FaultsBench(FaultsBenchOptions options) : options_(std::move(options)) {
    options_.config = fs::absolute(options_.config).string();
    options_.procman_config = fs::absolute(options_.procman_config).string();
  }

  void measure(Fault fault) {
    if (options_.seconds > 0) fault.seconds = options_.seconds;
    const evaluate::StoredMap* wanted = undisturbed(fault.seconds);
    FaultRow row;
    for (int attempt = 1; attempt <= kAttempts; ++attempt) {
      row = drive_with(fault, attempt, wanted);
      if (!row.is_spoiled()) break;
      fmt::print(stderr, "bench faults: {}: the emulator was {:.2f} s late: {}\n", fault.name, row.emulator_late_s,
                 attempt < kAttempts ? "driven once more" : "SPOILED by a busy machine: not compared");
    }
    report_.rows.push_back(row);
  }

  [[nodiscard]] const FaultReport& report() const { return report_; }

 private:
  [[nodiscard]] StackOptions stack(const Fault& fault, const std::string& name) const {
    StackOptions stack;
    stack.folder = (fs::path(options_.folder) / name).string();
    stack.spool = (fs::path(options_.folder) / fmt::format("packets-{}", fault.seconds)).string();
    stack.procman_config = options_.procman_config;
    stack.config = options_.config;
    stack.seconds = fault.seconds;
    stack.simulate = fault.simulate;
    stack.disk_mb = fault.disk_mb;
    fs::create_directories(stack.folder);
    return stack;
  }

  [[nodiscard]] FaultRow drive_with(const Fault& fault, int attempt, const evaluate::StoredMap* wanted) const {
    StackDrive drive(stack(fault, fmt::format("row-{}-{}", report_.rows.size(), attempt)));
    fault.happen(drive);
    drive.finish();
    FaultRow row;
    row.fault = fault.name;
    row.drives = attempt;
    row.seconds = fault.seconds;
    row.is_undisturbed = fault.name.starts_with("none");
    row.excuse = fault.excuse;
    row.emulator_late_s = drive.emulator_late();
    row.said = drive.faults_said();
    row.ended_cleanly = drive.ended_cleanly();
    if (!row.is_spoiled()) row.back_s = drive.back_within();
    judge(drive.map_file(), row.is_spoiled() ? nullptr : wanted, row);
    return row;
  }

  /// The replay of a drive without faults, driven at the first call. Null: the machine was too busy.
  const evaluate::StoredMap* undisturbed(double seconds) {
    for (int attempt = 1; attempt <= kAttempts && !undisturbed_.contains(seconds); ++attempt) {
      evaluate::StoredMap map = drive_undisturbed(seconds, attempt);
      const Undisturbed& drive = report_.undisturbed.back();
      fmt::print(stderr, "bench faults: {}\n", to_line(drive));
      if (!drive.is_spoiled())
        undisturbed_.emplace(seconds, std::move(map));
      else if (attempt == kAttempts)
        undisturbed_.emplace(seconds, std::nullopt);
    }
    const auto& map = undisturbed_.at(seconds);
    return map ? &*map : nullptr;
  }

  evaluate::StoredMap drive_undisturbed(double seconds, int attempt) {
    StackDrive drive(stack({"", {}, seconds}, fmt::format("undisturbed-{}-{}", seconds, attempt)));
    drive.fault_is_over();  // ignores faults reported during start-up
    drive.finish();
    const std::string file = drive.map_file() + ".replayed";
    const std::string line = fmt::format("curbstone replay '{}' --map '{}' --config '{}' >'{}.out' 2>&1",
                                         drive.log_file(), file, options_.config, file);
    if (std::system(line.c_str()) != 0) throw std::runtime_error("the undisturbed drive has no replay: " + line);
    evaluate::StoredMap map = read_map(file);
    FaultRow live;
    judge(drive.map_file(), &map, live);
    report_.undisturbed.push_back({.seconds = seconds,
                                   .cells = known_cells(map),
                                   .poses = static_cast<int>(map.trajectory.size()),
                                   .emulator_late_s = drive.emulator_late(),
                                   .revolutions_lost = revolutions_lost(map),
                                   .live_cells_differ = live.cells_differ.value_or(0),
                                   .live_poses_missing = live.poses_missing.value_or(0),
                                   .said = drive.faults_said()});
    return map;
  }

  static void judge(const std::string& map_file, const evaluate::StoredMap* wanted, FaultRow& row) {
    evaluate::StoredMap map;
    try {
      row.map = MapReader(map_file).integrity();
      map = read_map(map_file);
    } catch (const std::exception& error) {
      row.map = error.what();
    }
    if (wanted == nullptr) return;
    row.cells_differ = evaluate::difference(map, *wanted).classes_differ;
    row.poses_missing =
        std::max(0, static_cast<int>(wanted->trajectory.size()) - static_cast<int>(map.trajectory.size()));
  }

  FaultsBenchOptions options_;
  std::map<double, std::optional<evaluate::StoredMap>> undisturbed_;  // by length; empty: spoiled
  FaultReport report_;
};

int measure_all(const FaultsBenchOptions& options) {
  FaultsBench bench(options);
  for (const Fault& fault : chosen(all_faults(), options.only)) {
    fmt::print(stderr, "bench faults: {}\n", fault.name);
    bench.measure(fault);
    if (!options.json.empty()) write_report(bench.report(), options.json);  // kept if a later row fails
  }
  if (bench.report().rows.empty()) throw std::runtime_error("no row's name contains '" + options.only + "'");
  for (const Undisturbed& drive : bench.report().undisturbed) fmt::print("{}\n", to_line(drive));
  for (const std::string& line : table_lines(bench.report())) fmt::print("{}\n", line);
  if (!options.check) return 0;
  const std::vector<std::string> broken = broken_limits(bench.report());
  for (const std::string& row : unjudged(bench.report())) fmt::print("NOT JUDGED, the machine was busy: {}\n", row);
  for (const std::string& line : broken) fmt::print("BROKEN {}\n", line);
  return broken.empty() ? 0 : 1;
}

}  // namespace

int run_bench_faults(int argc, char** argv) {
  FaultsBenchOptions options;
  CommandLine line(
      "What is lost when processes die, hang or starve: a table, a row a fault, each a drive of the demo's processes "
      "in real time. They need a bus of their own: scripts/isolated curbstone bench faults",
      "curbstone bench faults");
  line.option("--only", options.only, "The row of this name, or the rows whose name contains it, or one of: this|that");
  line.option("--seconds", options.seconds,
              "Length of each drive (default: 18, where something happens every few seconds 60)")
      .within(12.0, 600.0);
  line.option("--procman", options.procman_config, "The processes: a config with a script 'stack'").shows_default();
  line.option("--config", options.config, "The vehicle's YAML file").shows_default();
  line.option("--keep", options.folder, "Keep what the drives left in this folder");
  line.flag("--list", options.list, "Only name the rows");
  line.flag("--check", options.check, "Exit with status 1 if a row breaks its limits (tools/bench/faults/README.md)");
  line.option("--json", options.json, "Write the figures to this file too");
  if (const auto status = line.read(argc, argv)) return *status;
  if (options.list) {
    for (const Fault& fault : all_faults()) fmt::print("{}\n", fault.name);
    return 0;
  }
  const bool temporary = options.folder.empty();
  int status = 1;
  try {
    std::string pattern = (fs::temp_directory_path() / "bench_faults_XXXXXX").string();
    if (temporary && mkdtemp(pattern.data()) == nullptr) throw std::runtime_error(pattern + ": cannot be made");
    if (temporary) options.folder = pattern;
    options.folder = fs::absolute(options.folder).string();
    status = measure_all(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "curbstone bench faults: {}\n", error.what());
  }
  if (temporary && !options.folder.empty()) {
    std::error_code ignored;
    fs::remove_all(options.folder, ignored);
  }
  return status;
}

}  // namespace curbstone::bench::faults
