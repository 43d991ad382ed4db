#include "tools/bench/voting/timed_in_turn.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>

namespace curbstone {

namespace {

/// Keeps what Google Benchmark measures instead of printing it.
class Collector final : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& /*context*/) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.iterations > 0) seconds = run.real_accumulated_time / static_cast<double>(run.iterations);
    }
  }
  double seconds = 0;
};

/// s of one piece of work, in one turn.
double take_turn(const Contender& contender, double min_time) {
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
  return collector.seconds;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::vector<double> time_in_turn(std::span<const Contender> contenders, const TurnOptions& options) {
  std::vector<std::vector<double>> seconds(contenders.size());
  for (int round = 0; round < options.rounds; ++round) {
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      if (round > 0 && seconds[i].front() > options.slow) continue;
      seconds[i].push_back(take_turn(contenders[i], options.min_time));
    }
  }
  std::vector<double> ms;
  for (auto& of_one : seconds) ms.push_back(1e3 * median(std::move(of_one)));
  return ms;
}

}  // namespace curbstone
