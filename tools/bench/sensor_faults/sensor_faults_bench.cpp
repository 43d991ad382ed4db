#include "tools/bench/sensor_faults/sensor_faults_bench.hpp"

#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/config/command_line.hpp"
#include "tools/bench/sensor_faults/catalogue/catalogue.hpp"
#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"
#include "tools/bench/sensor_faults/report.hpp"
#include "tools/bench/sensor_faults/trial.hpp"
#include "tools/simulate/simulate.hpp"

namespace curbstone::bench::sensor_faults {

namespace {

namespace fs = std::filesystem;

struct BenchOptions {
  std::uint64_t seed = 31;
  double seconds = 60;
  std::string log, truth;
  std::string only, json;
  int jobs = 1;
  bool list = false;
  bool faultless = false;
};

std::vector<catalogue::Fault> wanted(const BenchOptions& options) {
  return catalogue::named(options.faultless ? catalogue::faultless_drives() : catalogue::all_faults(), options.only);
}

/// `curbstone simulate` into `log` and `truth`. Throws std::runtime_error.
void simulate_drive(std::vector<std::string> arguments, const std::string& log, const std::string& truth) {
  std::vector<std::string> words = {"simulate", "--log", log, "--truth", truth};
  if (std::ranges::find(arguments, "--straight") == arguments.end()) words.emplace_back("--town");
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  if (simulate::run_simulate(static_cast<int>(argv.size()), argv.data()) != 0)
    throw std::runtime_error("the town cannot be simulated");
}

/// The rows in the order of the catalogue, of which several are in work at a time.
class Rows {
 public:
  Rows(const TrueDrive& drive, std::string folder, std::vector<catalogue::Fault> faults, std::string json)
      : drive_(drive), folder_(std::move(folder)), faults_(std::move(faults)), json_(std::move(json)) {}

  std::vector<Row> measure(int jobs) {
    const catalogue::Fault none{.sensor = "none", .name = "none", .words = "the undisturbed drive"};
    undisturbed_ = try_fault(drive_, none, folder_);
    if (!undisturbed_.map) throw std::runtime_error("the undisturbed drive: " + undisturbed_.failure);
    Row row = row_of(none, undisturbed_, {});  // all that it says is a false alarm
    fmt::print(stderr, "bench sensor-faults: {}: F1 {:.3f}, {}\n", none.name, row.map->f1, row.verdict());
    rows_.assign(1 + faults_.size(), std::nullopt);
    rows_[0] = std::move(row);
    std::vector<std::thread> threads;
    for (int i = 1; i < jobs; ++i) threads.emplace_back([this] { work(); });
    work();
    for (std::thread& thread : threads) thread.join();
    return ready();
  }

 private:
  /// The row of a drive of its own, of which all that is said is a false alarm.
  [[nodiscard]] Row faultless_row(const catalogue::Fault& drive) const {
    const std::string log = folder_ + "/" + drive.name + ".lcmlog", truth = folder_ + "/" + drive.name;
    simulate_drive(drive.drive, log, truth);
    Row row = row_of(drive, try_fault(TrueDrive(log, truth), drive, folder_), {});
    fs::remove(log);
    return row;
  }
  void work() {
    for (std::size_t i = next_++; i < faults_.size(); i = next_++) {
      const catalogue::Fault& fault = faults_[i];
      Row row =
          fault.drive.empty() ? row_of(fault, try_fault(drive_, fault, folder_), undisturbed_) : faultless_row(fault);
      const std::lock_guard lock(mutex_);
      fmt::print(stderr, "bench sensor-faults: {}: {}: F1 {:.3f}, {}\n", row.sensor, row.name,
                 row.map ? row.map->f1 : 0, row.verdict());
      rows_[1 + i] = std::move(row);
      if (!json_.empty()) write_report(ready(), json_);  // kept if a later row fails
    }
  }
  [[nodiscard]] std::vector<Row> ready() const {
    std::vector<Row> rows;
    for (const auto& row : rows_)
      if (row) rows.push_back(*row);
    return rows;
  }

  const TrueDrive& drive_;
  std::string folder_;
  std::vector<catalogue::Fault> faults_;
  std::string json_;
  Outcome undisturbed_;
  std::atomic<std::size_t> next_{0};
  std::mutex mutex_;                      // of rows_, the JSON file and stderr
  std::vector<std::optional<Row>> rows_;  // the undisturbed drive, then the faults
};

int measure_all(BenchOptions options, const std::string& folder) {
  std::vector<catalogue::Fault> faults = wanted(options);
  if (options.log.empty()) {
    options.log = folder + "/town.lcmlog";
    options.truth = folder + "/truth";
    simulate_drive({"--seed", fmt::to_string(options.seed), "--seconds", fmt::to_string(options.seconds)}, options.log,
                   options.truth);
  }
  const TrueDrive drive(options.log, options.truth);
  const std::vector<Row> rows = Rows(drive, folder, std::move(faults), options.json).measure(options.jobs);
  if (!options.json.empty()) write_report(rows, options.json);
  for (const std::string& line : table_lines(rows)) fmt::print("{}\n", line);
  return 0;
}

}  // namespace

int run_bench_sensor_faults(int argc, char** argv) {
  BenchOptions options;
  CommandLine line(
      "What a wrong sensor makes of the map of a simulated town, and what the services say of it: a table, a row a "
      "fault, each a replay",
      "curbstone bench sensor-faults");
  line.option("--seed", options.seed, "Of the town").shows_default();
  line.option("--seconds", options.seconds, "Length of the drive; the later faults begin at 15 s")
      .within(20.0, 3600.0)
      .shows_default();
  line.option("--log", options.log, "Instead of a simulated drive, this log; with --truth");
  line.option("--truth", options.truth, "The truth folder of --log");
  line.option("--only", options.only, "Only the faults of which 'sensor: name' has a match of this regular expression");
  line.flag("--faultless", options.faultless,
            "Instead of the faults, drives in which nothing is wrong: what is said of them are false alarms");
  line.option("--jobs", options.jobs, "Replays at a time; the figures are the same").within(1, 256).shows_default();
  line.flag("--list", options.list, "Only name the faults");
  line.option("--json", options.json, "Write the figures to this file too");
  if (const auto status = line.read(argc, argv)) return *status;
  if (options.log.empty() != options.truth.empty()) return line.refuse("--log and --truth belong together");
  std::string folder = (fs::temp_directory_path() / "bench_sensor_faults_XXXXXX").string();
  int status = 1;
  try {
    if (options.list) {
      for (const auto& fault : wanted(options)) fmt::print("{}: {}: {}\n", fault.sensor, fault.name, fault.words);
      return 0;
    }
    if (mkdtemp(folder.data()) == nullptr) throw std::runtime_error(folder + ": cannot be made");
    status = measure_all(options, folder);
  } catch (const std::exception& error) {
    fmt::print(stderr, "curbstone bench sensor-faults: {}\n", error.what());
  }
  std::error_code ignored;
  if (!folder.ends_with("XXXXXX")) fs::remove_all(folder, ignored);
  return status;
}

}  // namespace curbstone::bench::sensor_faults
