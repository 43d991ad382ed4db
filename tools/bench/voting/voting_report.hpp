#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/bench/voting/batch_comparison.hpp"
#include "tools/bench/voting/cuda_comparison.hpp"
#include "tools/bench/voting/fma_peak.hpp"
#include "tools/bench/voting/incremental_timing.hpp"

namespace curbstone::bench::voting {

/// All measurements of `curbstone bench voting`.
struct VotingReport {
  std::string kernel;  ///< used on this machine
  FmaPeak peak;
  std::vector<BatchRow> batch;
  std::vector<BatchRow> growth;  ///< ours alone: longer streets of equal density, denser streets, threads
  std::vector<CudaRow> cuda;     ///< the batch on a GPU; empty without one
  double stick_sum = 0;
  std::optional<IncrementalTiming> incremental;
};

/// Tables for people, on stdout.
void print_report(const VotingReport& report);

/// Writes the same figures as JSON; what was not measured is null. Throws std::runtime_error if the file cannot be
/// written.
void write_report(const VotingReport& report, const std::string& file);

}  // namespace curbstone::bench::voting
