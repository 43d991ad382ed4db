#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "services/tensor_voting/cuda/batch_pipeline.hpp"
#include "services/tensor_voting/cuda/resident_voters.hpp"

namespace curbstone::tensor_voting::cuda {

/// @file
/// What nvcc compiles, seen from C++: no CUDA in it, and no Eigen, which nvcc had better not see. Where there is no
/// nvcc, cuda_backend_absent.cpp stands in its place.

/// Empty if there is a device that can be used.
[[nodiscard]] std::string why_no_device();

/// Throw std::runtime_error with what CUDA has to say, and so does what they make.
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
