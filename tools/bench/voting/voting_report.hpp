#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/bench/voting/batch_comparison.hpp"
#include "tools/bench/voting/cuda_comparison.hpp"
#include "tools/bench/voting/fma_peak.hpp"
#include "tools/bench/voting/incremental_timing.hpp"

namespace curbstone::bench::voting {

/// All that `curbstone bench voting` has measured.
struct VotingReport {
  std::string kernel;  ///< that this machine runs
  FmaPeak peak;
  std::vector<BatchRow> batch;
  std::vector<BatchRow> growth;  ///< ours alone: longer streets of one density, denser streets, threads
  std::vector<CudaRow> cuda;     ///< the batch again, on a GPU; none where there is none
  double stick_sum = 0;
  std::optional<IncrementalTiming> incremental;
};

/// Tables for people, on stdout.
void print_report(const VotingReport& report);

/// The same figures for programs; what was not measured is null. Throws std::runtime_error when the file cannot be
/// written.
void write_report(const VotingReport& report, const std::string& file);

}  // namespace curbstone::bench::voting
