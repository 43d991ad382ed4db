#include "tools/bench/voting/cuda_comparison.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/bench/voting/inputs/street_cloud.hpp"

namespace curbstone::bench::voting {

std::vector<CudaRow> measure_cuda(std::span<const BatchRow> rows, int repeats) {
  std::vector<CudaRow> measured;
  if (!tensor_voting::cuda::cuda_available()) return measured;
  for (const BatchRow& row : rows) {
    const auto timings = tensor_voting::cuda::time_cuda_voting(
        inputs::street_cloud(row.points, row.length), {.sigma = row.sigma, .radius = row.radius, .voxel = 0}, repeats);
    if (timings) measured.push_back({row, *timings});
  }
  return measured;
}

void print_cuda(std::span<const CudaRow> rows) {
  if (rows.empty()) {
    fmt::print("\nCUDA: {}\n", tensor_voting::cuda::why_no_cuda());
    return;
  }
  fmt::print("\nCUDA on {}: ms; the floors are what its peak rates of flops and bytes make of the kernel's votes\n",
             rows[0].gpu.device);
  fmt::print("  {:>9} {:>6} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>10} {:>8}\n", "points", "sigma", "upload",
             "sort", "vote", "download", "flops", "bytes", "call", "CPU", "ratio");
  for (const CudaRow& row : rows) {
    const tensor_voting::cuda::CudaTimings& t = row.gpu;
    fmt::print("  {:>9} {:>6.2f} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.3f} {:>8.3f} {:>8.2f} {:>10.2f} {:>7.1f}x\n",
               row.cpu.points, row.cpu.sigma, t.upload_ms, t.sort_ms, t.vote_ms, t.download_ms, t.flops_floor_ms,
               t.bytes_floor_ms, t.call_ms, row.cpu.ours.wall_ms, row.cpu.ours.wall_ms / t.call_ms);
  }
}

nlohmann::json cuda_json(std::span<const CudaRow> rows) {
  if (rows.empty()) return nullptr;
  nlohmann::json all = nlohmann::json::array();
  for (const CudaRow& row : rows) {
    const tensor_voting::cuda::CudaTimings& t = row.gpu;
    all.push_back({{"points", row.cpu.points},
                   {"sigma", row.cpu.sigma},
                   {"radius", row.cpu.radius},
                   {"device", t.device},
                   {"upload_ms", t.upload_ms},
                   {"sort_ms", t.sort_ms},
                   {"vote_ms", t.vote_ms},
                   {"download_ms", t.download_ms},
                   {"total_ms", t.total_ms},
                   {"call_ms", t.call_ms},
                   {"cpu_ms", row.cpu.ours.wall_ms},
                   {"ratio", row.cpu.ours.wall_ms / t.call_ms},
                   {"pairs_tested", t.pairs_tested},
                   {"pair_votes", t.pair_votes},
                   {"flops", t.flops},
                   {"bytes", t.bytes},
                   {"flops_floor_ms", t.flops_floor_ms},
                   {"bytes_floor_ms", t.bytes_floor_ms}});
  }
  return all;
}

}  // namespace curbstone::bench::voting
