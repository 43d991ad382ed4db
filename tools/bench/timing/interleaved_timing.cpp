#include "tools/bench/timing/interleaved_timing.hpp"

#include <benchmark/benchmark.h>

#include "common/statistics/quantile.hpp"

namespace curbstone::bench::timing {

namespace {

/// Collects Google Benchmark's results instead of printing them.
class Collector final : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& /*context*/) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.iterations == 0) continue;
      const double per_run = 1e3 / static_cast<double>(run.iterations);
      times = {run.real_accumulated_time * per_run, run.cpu_accumulated_time * per_run};
    }
  }
  TurnTimes times;
};

TurnTimes take_turn(const Contender& contender, double min_time) {
  benchmark::ClearRegisteredBenchmarks();
  benchmark::RegisterBenchmark(contender.name.c_str(),
                               [&](benchmark::State& state) {
                                 for (auto _ : state) contender.work();
                               })
      ->MinTime(min_time)
      ->UseRealTime();
  Collector collector;
  benchmark::RunSpecifiedBenchmarks(&collector, ".");
  benchmark::ClearRegisteredBenchmarks();
  return collector.times;
}

}  // namespace

std::vector<TurnTimes> time_in_turn(std::span<const Contender> contenders, const TurnOptions& options) {
  struct Turns {
    std::vector<double> wall_ms, cpu_ms;
  };
  std::vector<Turns> turns(contenders.size());
  for (int round = 0; round < options.rounds; ++round) {
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      if (round > 0 && turns[i].wall_ms.front() > 1e3 * options.slow) continue;
      const TurnTimes times = take_turn(contenders[i], options.min_time);
      turns[i].wall_ms.push_back(times.wall_ms);
      turns[i].cpu_ms.push_back(times.cpu_ms);
    }
  }
  std::vector<TurnTimes> medians;
  for (Turns& t : turns) medians.push_back({quantile_in_place(t.wall_ms, 0.5), quantile_in_place(t.cpu_ms, 0.5)});
  return medians;
}

}  // namespace curbstone::bench::timing
