#include "tools/bench/localisation/localisation_bench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "common/config/assignments.hpp"
#include "common/config/command_line.hpp"
#include "common/parallel/parallel_for.hpp"
#include "common/statistics/quantile.hpp"
#include "config/sections.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "tools/bench/localisation/trial.hpp"
#include "tools/evaluate/truth/truth.hpp"
#include "tools/output/text_file.hpp"

namespace curbstone::bench::localisation {
namespace {

constexpr std::array<std::string_view, 2> kSections = {"ekf", "localizer"};

constexpr double kWithin = 20.0;   // m driven within which the vehicle must be localised
constexpr double kCarried = 15.0;  // m, minimum distance that it is carried
constexpr std::int64_t kSecond = 1'000'000;
constexpr std::int64_t kKnown = 3 * kSecond;  // before it is carried
constexpr std::int64_t kFind = 10 * kSecond;  // after it

struct Options {
  std::string map, log, truth, map_truth, config, json;
  std::vector<std::string> assignments;
  int starts = 200, carried = 20;
  int seed = 1;
  int threads = 2;
};

struct Run {
  RecordedDrive drive;
  localizer::LocalizerConfig config;
  std::optional<localise::TrueMapPose> truth;
  std::mt19937_64 random;
  int threads = 1;

  [[nodiscard]] std::int64_t time_between(std::int64_t from, std::int64_t to) {
    return from +
           static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(std::max<std::int64_t>(to - from, 1)));
  }
  [[nodiscard]] const localise::TrueMapPose* true_pose() const { return truth ? &*truth : nullptr; }
};

nlohmann::json spread(const std::vector<double>& values) {
  return {{"p50", quantile_or(values, 0.5, 0)},
          {"p95", quantile_or(values, 0.95, 0)},
          {"max", values.empty() ? 0 : *std::max_element(values.begin(), values.end())}};
}

void take_costs(const std::vector<Said>& all, std::vector<double>& ms) {
  for (const Said& said : all) {
    if (!said.sure) ms.push_back(said.ms);
  }
}

/// A trial that starts somewhere along the drive.
struct Start {
  std::int64_t from = 0, until = 0;  // us
  std::vector<Said> said;
};

/// Trials without a prior, from places along the drive.
std::vector<Start> tried_starts(Run& run, int count) {
  const RecordedDrive& drive = run.drive;
  std::int64_t last = drive.end();
  while (last > drive.begin() && drive.driven_at(drive.end()) - drive.driven_at(last) < kWithin) last -= kSecond / 10;
  std::vector<Start> starts(static_cast<std::size_t>(count));
  for (Start& start : starts) {
    start.from = start.until = run.time_between(drive.begin(), last);
    while (start.until < drive.end() && drive.driven_at(start.until) - drive.driven_at(start.from) < kWithin)
      start.until += kSecond / 20;
  }
  parallel_for(starts.size(), 1, run.threads, [&](std::size_t i, std::size_t /*end*/) {
    Trial trial(run.config, drive, run.true_pose());
    trial.play(starts[i].from, starts[i].until);
    starts[i].said = trial.said();
  });
  return starts;
}

nlohmann::json random_starts(Run& run, int count) {
  int right = 0, wrong = 0, wrong_revolutions = 0;
  std::vector<double> metres, seconds, ms;
  const RecordedDrive& drive = run.drive;
  for (const auto& [from, until, said] : tried_starts(run, count)) {
    take_costs(said, ms);
    const auto found = std::find_if(said.begin(), said.end(), [](const Said& s) { return s.right(); });
    const auto bad = std::count_if(said.begin(), said.end(), [](const Said& s) { return s.wrong(); });
    wrong += bad > 0 ? 1 : 0;
    wrong_revolutions += static_cast<int>(bad);
    if (bad > 0)
      fmt::print("  start at {:.2f} s: sure and wrong for {} revolutions\n",
                 static_cast<double>(from - drive.begin()) * 1e-6, bad);
    if (found == said.end() && !run.truth) continue;
    if (found == said.end()) {
      fmt::print("  start at {:.2f} s: not found\n", static_cast<double>(from - drive.begin()) * 1e-6);
      continue;
    }
    ++right;
    metres.push_back(drive.driven_at(found->utime) - drive.driven_at(from));
    seconds.push_back(static_cast<double>(found->utime - from) * 1e-6);
  }
  return {{"starts", count},
          {"right_within_20_m", right},
          {"right_share", count > 0 ? 1.0 * right / count : 0},
          {"wrong_but_sure", wrong},
          {"wrong_revolutions", wrong_revolutions},
          {"metres", spread(metres)},
          {"seconds", spread(seconds)},
          {"lost_ms", spread(ms)}};
}

/// A trial in which the vehicle is moved from the cut to another place of the drive.
struct Carried {
  std::int64_t cut = 0, there = 0;  // us
  std::vector<double> start;        // X, Y, YAW at kKnown before the cut
  std::vector<Said> said;           // after the cut
};

std::vector<Carried> tried_carrying(Run& run, int count) {
  const RecordedDrive& drive = run.drive;
  std::vector<Carried> all;
  for (int i = 0; i < 20 * count && all.size() < static_cast<std::size_t>(count); ++i) {
    Carried one;
    one.cut = run.time_between(drive.begin() + kKnown, drive.end());
    one.there = run.time_between(drive.begin(), drive.end() - kFind);
    const auto start = run.truth->at(one.cut - kKnown), before = run.truth->at(one.cut),
               after = run.truth->at(one.there);
    if (!start || !before || !after || (before->translation() - after->translation()).norm() < kCarried) continue;
    one.start = {start->translation().x(), start->translation().y(), roll_pitch_yaw(start->linear()).z()};
    all.push_back(std::move(one));
  }
  parallel_for(all.size(), 1, run.threads, [&](std::size_t i, std::size_t /*end*/) {
    Carried& one = all[i];
    localizer::LocalizerConfig config = run.config;
    config.start = one.start;
    Trial trial(config, drive, run.true_pose());
    trial.play(one.cut - kKnown, one.cut);
    const auto heard = static_cast<std::ptrdiff_t>(trial.said().size());
    trial.play(one.there, one.there + kFind);
    one.said.assign(trial.said().begin() + heard, trial.said().end());
  });
  return all;
}

nlohmann::json carried_away(Run& run, int count) {
  int noticed = 0, found = 0, wrong_revolutions = 0;
  std::vector<double> lost_after, found_after, ms;
  const auto tried = tried_carrying(run, count);
  for (const Carried& one : tried) {
    const std::vector<Said>& said = one.said;
    take_costs(said, ms);
    const auto after_s = [&](const Said& s) { return static_cast<double>(s.utime - one.there) * 1e-6; };
    const auto lost = std::find_if(said.begin(), said.end(), [](const Said& s) { return !s.sure; });
    const auto again = std::find_if(lost, said.end(), [](const Said& s) { return s.right(); });
    if (lost != said.end()) lost_after.push_back(after_s(*lost));
    if (again != said.end()) found_after.push_back(after_s(*again));
    noticed += lost != said.end() && after_s(*lost) <= 1 ? 1 : 0;
    found += again != said.end() ? 1 : 0;
    wrong_revolutions += static_cast<int>(std::count_if(lost, said.end(), [](const Said& s) { return s.wrong(); }));
    const double begun = static_cast<double>(one.there - run.drive.begin()) * 1e-6;
    if (lost == said.end() || after_s(*lost) > 1) fmt::print("  carried to {:.2f} s: not LOST within 1 s\n", begun);
    if (again == said.end()) fmt::print("  carried to {:.2f} s: not found\n", begun);
  }
  return {{"carried", tried.size()},      {"lost_within_1_s", noticed},
          {"found_within_10_s", found},   {"wrong_revolutions_once_lost", wrong_revolutions},
          {"lost_s", spread(lost_after)}, {"found_s", spread(found_after)},
          {"lost_ms", spread(ms)}};
}

void print(const nlohmann::json& starts, const nlohmann::json& carried) {
  const auto of = [](const nlohmann::json& j, const char* what, const char* which) {
    return j[what][which].get<double>();
  };
  fmt::print("{} starts anywhere: {} right within 20 m, {} sure and wrong; after {:.1f} m (p50), {:.1f} (p95)\n",
             starts["starts"].get<int>(), starts["right_within_20_m"].get<int>(), starts["wrong_but_sure"].get<int>(),
             of(starts, "metres", "p50"), of(starts, "metres", "p95"));
  fmt::print("  a lost revolution: {:.1f} ms of CPU (p50), {:.1f} (p95), {:.1f} (max)\n", of(starts, "lost_ms", "p50"),
             of(starts, "lost_ms", "p95"), of(starts, "lost_ms", "max"));
  if (carried.is_null()) return;
  fmt::print(
      "{} times carried away: {} LOST within 1 s ({:.2f} s at most), {} found within 10 s ({:.1f} s p50), {} "
      "revolutions sure "
      "and wrong after that\n",
      carried["carried"].get<int>(), carried["lost_within_1_s"].get<int>(), of(carried, "lost_s", "max"),
      carried["found_within_10_s"].get<int>(), of(carried, "found_s", "p50"),
      carried["wrong_revolutions_once_lost"].get<int>());
}

int measure(const Options& options) {
  auto ekf = config_of<ekf::base::EkfConfig>("ekf", kProcessSections, options.config, options.assignments);
  ekf.state_file.clear();  // its state is of another vehicle or time
  auto config =
      config_of<localizer::LocalizerConfig>("localizer", kProcessSections, options.config, options.assignments);
  config.map = options.map;
  config.start.clear();
  Run run{RecordedDrive(options.log, ekf), config, std::nullopt,
          std::mt19937_64(static_cast<std::uint64_t>(options.seed)), options.threads};
  if (!options.truth.empty())
    run.truth.emplace(semantic_map::store::MapReader(options.map).trajectory(),
                      evaluate::truth::load_truth(options.map_truth).poses,
                      evaluate::truth::load_truth(options.truth).poses);
  { const Trial says_what_is_wrong(run.config, run.drive, run.true_pose()); }  // throws before there are threads
  const nlohmann::json starts = random_starts(run, options.starts);
  const nlohmann::json carried = run.truth ? carried_away(run, options.carried) : nlohmann::json();
  print(starts, carried);
  if (options.json.empty()) return 0;
  output::write_text(options.json, nlohmann::json{{"starts", starts}, {"carried", carried}}.dump(2) + "\n");
  return 0;
}

}  // namespace

int run_bench_localisation(int argc, char** argv) {
  Options options;
  CommandLine line("A vehicle of which nothing is known, and one that is carried away: found in a saved map",
                   "curbstone bench localisation");
  line.argument("map", options.map, "The map").required();
  line.option("--log", options.log, "Log of another drive with LIDAR_POINTS, IMU and WHEELS").required();
  line.option("--truth", options.truth, "Truth folder of that drive; without it, the map is of another place");
  line.option("--map-truth", options.map_truth, "Truth folder of the drive that made the map");
  line.option("--starts", options.starts, "Places along the drive from which nothing is known");
  line.option("--carried", options.carried, "Times that the vehicle is carried from one place of the drive to another");
  line.option("--seed", options.seed, "Of the places");
  line.option("--threads", options.threads, "As many places at a time; what is found does not depend on it");
  line.option("--config", options.config, "The vehicle's YAML file");
  line.option("--set", options.assignments, "SECTION.KEY=VALUE, over the file").one_each();
  line.option("--json", options.json, "Write the figures here, for programs");
  if (const auto status = line.read(argc, argv)) return *status;
  options.assignments = assignments_for(kSections, options.assignments);
  if (options.truth.empty() != options.map_truth.empty()) return line.refuse("--truth and --map-truth belong together");
  return measure(options);
}

}  // namespace curbstone::bench::localisation
