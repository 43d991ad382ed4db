#include "tools/bench/voting/voting_bench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <string>
#include <vector>

#include "common/config/command_line.hpp"
#include "services/tensor_voting/cuda/cuda_voting.hpp"
#include "services/tensor_voting/kernels/instruction_sets.hpp"
#include "services/tensor_voting/kernels/vote_kernel.hpp"
#include "tools/bench/voting/voting_report.hpp"

namespace curbstone::bench::voting {

namespace {

struct VotingBenchOptions {
  std::vector<std::size_t> points = {50'000, 100'000, 200'000, 1'000'000};
  std::vector<double> sigmas = {0.3, 0.1};
  int threads = 2;
  std::string kernel;
  std::size_t pcl_max_points = 1'000'000;
  timing::TurnOptions turns;
  inputs::DriveSource drive;
  bool no_growth = false;
  bool no_drive = false;
  bool on_gpu = false;
  std::string json;
};

void add_options(CommandLine& line, VotingBenchOptions& o) {
  line.option("--points", o.points, "Sizes of the street cloud, 20 m long")
      .comma_separated()
      .within(100, 10'000'000)
      .shows_default();
  line.option("--sigma", o.sigmas, "Decays, m; R is three times each")
      .comma_separated()
      .within(0.01, 1.0)
      .shows_default();
  line.option("--threads", o.threads, "For both sides").within(1, 256).shows_default();
  line.option("--kernel", o.kernel, "Instruction set of the batch; default: the fastest that this machine has")
      .one_of({"avx512", "avx2", "baseline"});
  line.option("--repetitions", o.turns.rounds, "Turns of each side, of which the median counts")
      .within(1, 1000)
      .shows_default();
  line.option("--min-time", o.turns.min_time, "s that a turn lasts at least").within(0.001, 60.0).shows_default();
  line.option("--slow", o.turns.slow, "s: whose turn takes longer has only one").shows_default();
  line.option("--pcl-max-points", o.pcl_max_points, "No PCL on larger clouds").shows_default();
  line.flag("--no-growth", o.no_growth, "Do not measure how the cost grows");
  line.flag("--no-drive", o.no_drive, "Do not measure a growing map");
  line.flag("--on-gpu", o.on_gpu, "Fail where there is no GPU to measure too");
  line.option("--seconds", o.drive.seconds, "s of the demo town's drive for the growing map")
      .within(1.0, 3600.0)
      .shows_default();
  line.option("--log", o.drive.log, "A log of lcm-logger with LIDAR_POINTS, IMU and WHEELS instead of that drive");
  line.option("--json", o.json, "Write the figures to this file too");
}

void print_line(const std::string& what) {
  fmt::print(stderr, "bench voting: {}\n", what);
}

BatchRow measured(BatchRow row, bool with_pcl, const VotingBenchOptions& o) {
  print_line(fmt::format("{} points on {} m, sigma {}, {} threads{}", row.points, row.length, row.sigma, row.threads,
                         with_pcl ? ", and PCL" : ""));
  measure_batch(row, with_pcl, o.kernel, o.turns);
  return row;
}

std::vector<BatchRow> measure_growth(const VotingBenchOptions& o) {
  const std::size_t points = std::min<std::size_t>(100'000, *std::max_element(o.points.begin(), o.points.end()));
  std::vector<BatchRow> rows;
  for (const int threads : {1, 2}) rows.push_back({.points = points, .threads = threads});
  for (const double length : {40.0, 80.0}) {  // longer streets of the same density
    rows.push_back({.points = points * static_cast<std::size_t>(length / 20), .length = length, .threads = o.threads});
  }
  for (const std::size_t factor : {2U, 4U}) rows.push_back({.points = points * factor, .threads = o.threads});
  for (BatchRow& row : rows) row = measured(row, false, o);
  return rows;
}

VotingReport measure(const VotingBenchOptions& o) {
  namespace kernels = tensor_voting::kernels;
  VotingReport report;
  report.kernel = kernels::kernel_for(kernels::vote_kernels(), o.kernel).name;
  report.peak = measure_fma_peak(o.threads, 0.5, o.kernel);
  for (const double sigma : o.sigmas) {
    for (const std::size_t points : o.points) {
      const BatchRow row{
          .points = points, .sigma = sigma, .radius = std::round(3e6 * sigma) / 1e6, .threads = o.threads};
      report.batch.push_back(measured(row, points <= o.pcl_max_points, o));
    }
  }
  report.cuda = measure_cuda(report.batch, o.turns.rounds);
  if (!o.no_growth) report.growth = measure_growth(o);
  report.stick_sum = stick_sum();
  if (!o.no_drive) {
    print_line(o.drive.log.empty() ? fmt::format("a drive of {} s", o.drive.seconds) : o.drive.log);
    report.incremental = time_incremental(o.drive);
  }
  const FmaPeak again = measure_fma_peak(o.threads, 0.5, o.kernel);  // takes the higher of the peaks before and after
  if (again.flops_per_s > report.peak.flops_per_s) report.peak = again;
  return report;
}

}  // namespace

int run_bench_voting(int argc, char** argv) {
  VotingBenchOptions options;
  CommandLine line(
      "Measures tensor voting: whole clouds beside PCL's NormalEstimationOMP with the same radius and threads, and a "
      "map that grows as the demo town is driven through",
      "curbstone bench voting");
  add_options(line, options);
  if (const auto status = line.read(argc, argv)) return *status;
  if (const std::string why = tensor_voting::cuda::why_no_cuda(); options.on_gpu && !why.empty()) {
    print_line(why);
    return 1;
  }
  const VotingReport report = measure(options);
  print_report(report);
  if (!options.json.empty()) write_report(report, options.json);
  return 0;
}

}  // namespace curbstone::bench::voting
