#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "services/tensor_voting/cuda/batch_pipeline.hpp"
#include "services/tensor_voting/cuda/resident_voters.hpp"

namespace curbstone::tensor_voting::cuda {

/// @file
/// The C++ interface of the part that nvcc compiles. It contains no CUDA, and no Eigen, because nvcc should not compile
/// Eigen. Without nvcc, cuda_backend_absent.cpp replaces that part.

/// Why no device can be used; empty if one can.
[[nodiscard]] std::string why_no_device();

/// These functions, and the objects that they make, throw std::runtime_error with CUDA's error text.
[[nodiscard]] std::unique_ptr<CloudBatch> make_cloud_batch();
[[nodiscard]] std::unique_ptr<ResidentVoters> make_resident_voters(const CellGrid& grid, const kernels::Decay& decay);

struct DeviceTimes {
  double upload_ms = 0;
  double sort_ms = 0;
  double vote_ms = 0;
  double download_ms = 0;
};
struct TimedBatch {
  std::vector<DeviceTimes> runs;
  BatchCounts counts;
  std::uint64_t tests = 0;
  std::uint64_t pair_votes = 0;
  std::string device;
  double device_flops_per_s = 0;
  double device_bytes_per_s = 0;
};
[[nodiscard]] TimedBatch time_on_device(const double* xyz, std::uint32_t num_points, const BatchRequest& request,
                                        int repeats);

}  // namespace curbstone::tensor_voting::cuda
