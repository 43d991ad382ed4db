#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "services/tensor_voting/cuda/cuda_voting.hpp"
#include "tools/bench/voting/batch_comparison.hpp"

namespace curbstone::bench::voting {

/// Figures of a GPU and of this machine's CPU on one street cloud.
struct CudaRow {
  BatchRow cpu;  ///< measured
  tensor_voting::cuda::CudaTimings gpu;
};

/// Measures each of the CPU's rows on the GPU; empty without a device.
[[nodiscard]] std::vector<CudaRow> measure_cuda(std::span<const BatchRow> rows, int repeats);

void print_cuda(std::span<const CudaRow> rows);
/// null if there are no rows.
[[nodiscard]] nlohmann::json cuda_json(std::span<const CudaRow> rows);

}  // namespace curbstone::bench::voting
