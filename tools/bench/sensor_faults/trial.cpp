#include "tools/bench/sensor_faults/trial.hpp"

#include <stdlib.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <curbstone/lidar_points_t.hpp>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "common/log/log_files.hpp"
#include "common/log/log_reader.hpp"
#include "common/log/message_order.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "tools/bench/sensor_faults/catalogue/faulty_messages.hpp"
#include "tools/evaluate/evaluation.hpp"
#include "tools/replay/vehicle_line.hpp"

namespace curbstone::bench::sensor_faults {

namespace {

namespace fs = std::filesystem;

constexpr double kLookEvery = 0.5;  // s of the drive
constexpr double kRadius = 8.0;     // m from the path, as in `curbstone evaluate`
constexpr std::size_t kTolerance = 2;
static_assert(evaluate::kTolerances[kTolerance] == 0.24);

/// A folder for the files of one replay.
class OwnFolder {
 public:
  explicit OwnFolder(const std::string& parent) : path_((fs::path(parent) / "trial_XXXXXX").string()) {
    if (mkdtemp(path_.data()) == nullptr) throw std::runtime_error(path_ + ": cannot be made");
  }
  ~OwnFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;

  [[nodiscard]] std::string file(const char* name) const { return (fs::path(path_) / name).string(); }

 private:
  std::string path_;
};

std::int32_t revolution_of(const LogEvent& event) {
  lidar_points_t points;
  return points.decode(event.bytes.data(), 0, static_cast<int>(event.bytes.size())) > 0 ? points.revolution : 0;
}

bool is_sensor(const std::string& channel) {
  return channel == "LIDAR_POINTS" || channel == "IMU" || channel == "WHEELS";
}

/// Drives, and returns the revolution in which the fault began.
std::int32_t drive_with(const TrueDrive& drive, const catalogue::Fault& fault, replay::VehicleLine& vehicle,
                        Witness& witness) {
  constexpr std::int64_t kLatest = 4'102'444'800'000'000;  // us: the year 2100; later times are refused, as in a replay
  LogReader log(drive.log);
  catalogue::FaultyMessages messages(fault.make(), fault.from);
  MessageOrder order;
  std::optional<std::int64_t> start;
  std::int32_t revolution = 0;
  double t = 0, looked = 0;
  const auto deliver = [&](LogEvent event) {
    const std::int64_t time = message_time(event);
    if (time <= 0 || time > kLatest) return;
    // The nodes are told the time by the host's clock, as the services are. order.time() follows one that is set ahead.
    const std::int64_t set_back = t >= fault.from ? std::min<std::int64_t>(fault.clock_set_by, 0) : 0;
    vehicle.deliver(order.time() + set_back, std::move(event.channel), std::move(event.bytes));
  };
  while (auto event = log.next()) {
    if (!is_sensor(event->channel)) continue;
    if (!start) start = event->log_utime;
    t = static_cast<double>(event->log_utime - *start) * 1e-6;
    if (t < fault.from && event->channel == "LIDAR_POINTS") revolution = revolution_of(*event);
    std::optional<LogEvent> second = messages.second(t, *event);
    if (messages.apply(t, *event)) order.push(std::move(*event));
    if (second) order.push(std::move(*second));
    while (auto ready = order.pop()) deliver(std::move(*ready));
    if (t < looked + kLookEvery) continue;
    looked = t;
    witness.look(t, vehicle.stages());
  }
  if (!start) throw std::runtime_error(drive.log + ": holds no LIDAR_POINTS, IMU or WHEELS");
  while (auto ready = order.pop_rest()) deliver(std::move(*ready));
  witness.look(t, vehicle.stages());
  vehicle.finish();
  return revolution;
}

/// The path by the clock of the truth, which nobody sets: `set_by`, us, in `revolution`. Its neighbours have stamps of
/// both clocks and are left out.
evaluate::truth::Trajectory path_of(const semantic_map::store::MapReader& map, std::int64_t set_by,
                                    std::int32_t revolution) {
  evaluate::truth::Trajectory path;
  for (const auto& pose : map.trajectory()) {
    if (set_by != 0 && std::abs(pose.revolution - revolution) <= 1) continue;
    path.push_back({pose.utime - (pose.revolution > revolution ? set_by : 0), pose.T_map_base});
  }
  std::sort(path.begin(), path.end(), [](const auto& a, const auto& b) { return a.utime < b.utime; });
  return path;
}

MapFigures figures_of(const std::string& file, const evaluate::truth::Truth& truth, std::int64_t set_by,
                      std::int32_t revolution) {
  const semantic_map::store::MapReader map(file);
  const evaluate::truth::Trajectory path = path_of(map, set_by, revolution);
  const evaluate::Evaluation evaluation = evaluate::evaluate(map.tiles(), map.curbs(), path, truth, kRadius);
  MapFigures figures{.ate = evaluation.trajectory.ate_m};
  if (evaluation.curbs) {
    const evaluate::Score& score = evaluation.curbs->at[kTolerance];
    figures.precision = score.precision;
    figures.recall = score.recall;
    figures.f1 = score.f1();
  }
  if (evaluation.classes) figures.class_accuracy = evaluation.classes->accuracy();
  return figures;
}

}  // namespace

TrueDrive::TrueDrive(std::string log_file, const std::string& truth_folder)
    : log(std::move(log_file)), truth(evaluate::truth::load_truth(truth_folder)) {
  LogFiles head({log});
  recorded = recording::recorded_config(head);
}

Outcome try_fault(const TrueDrive& drive, const catalogue::Fault& fault, const std::string& folder) {
  const OwnFolder own(folder);
  replay::ReplayOptions options;
  options.recorded = drive.recorded;
  options.assignments = fault.settings;
  options.map_file = own.file("map.db");
  options.keep_earlier_drives = true;
  Outcome outcome;
  try {
    std::int32_t revolution = 0;
    {
      replay::VehicleLine vehicle(options, {.threads = false, .everything = {}});
      revolution = drive_with(drive, fault, vehicle, outcome.witness);
    }
    outcome.map = figures_of(options.map_file, drive.truth, fault.clock_set_by, revolution);
  } catch (const std::exception& error) {
    outcome.failure = error.what();
  }
  return outcome;
}

}  // namespace curbstone::bench::sensor_faults
