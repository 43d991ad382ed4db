#include "services/tensor_voting/cuda/cuda_backend.hpp"

#include <chrono>

#include "services/tensor_voting/cuda/cuda_machine.cuh"
#include "services/tensor_voting/cuda/field_pipeline.hpp"

namespace curbstone::tensor_voting::cuda {

namespace {

int attribute(cudaDeviceAttr name) {
  int device = 0;
  int value = 0;
  check(cudaGetDevice(&device), "no device");
  check(cudaDeviceGetAttribute(&value, name, device), "an attribute of the device");
  return value;
}

/// Single-precision lanes of a multiprocessor (CUDA C++ Programming Guide, arithmetic throughput).
int lanes_per_multiprocessor(int major, int minor) {
  return major == 7 || (major == 8 && minor == 0) ? 64 : 128;
}

}  // namespace

std::string why_no_device() {
  int count = 0;
  const cudaError_t error = cudaGetDeviceCount(&count);
  if (error != cudaSuccess) return std::string("no CUDA device: ") + cudaGetErrorString(error);
  if (count == 0) return "no CUDA device";
  try {
    if (attribute(cudaDevAttrMemoryPoolsSupported) == 0) return "the CUDA device has no memory pools";
    cudaFuncAttributes attributes{};
    check(cudaFuncGetAttributes(&attributes, run_each<CountKinds>), "no code for this device");
  } catch (const std::runtime_error& failure) {
    return failure.what();
  }
  return {};
}

std::unique_ptr<CloudBatch> make_cloud_batch() {
  return std::make_unique<CloudBatchOn<CudaMachine>>(CudaMachine());
}

TimedBatch time_on_device(const double* xyz, std::uint32_t num_points, const BatchRequest& request, int repeats) {
  TimedBatch timed;
  CudaMachine machine;
  BatchPipeline<CudaMachine> pipeline(machine);
  std::vector<kernels::TensorF> tensors;
  std::vector<VotedShape> shapes;
  auto lap = [&, last = std::chrono::steady_clock::now()]() mutable {
    machine.synchronize();
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double, std::milli>(now - std::exchange(last, now)).count();
  };
  for (int i = -1; i < repeats; ++i) {  // the first call loads code and allocates memory, and is not counted
    DeviceTimes times;
    lap();
    pipeline.upload(xyz, num_points);
    times.upload_ms = lap();
    pipeline.prepare(request);
    times.sort_ms = lap();
    pipeline.vote();
    times.vote_ms = lap();
    pipeline.download(tensors, shapes);
    times.download_ms = lap();
    if (i >= 0) timed.runs.push_back(times);
  }
  timed.counts = pipeline.counts();
  timed.tests = pipeline.count_tests();
  timed.pair_votes = pipeline.count_pair_votes();

  int device = 0;
  cudaDeviceProp properties{};
  check(cudaGetDevice(&device), "no device");
  check(cudaGetDeviceProperties(&properties, device), "the device's properties");
  timed.device = properties.name;
  const double lanes = static_cast<double>(properties.multiProcessorCount) *
                       lanes_per_multiprocessor(properties.major, properties.minor);
  timed.device_flops_per_s = 2e3 * lanes * attribute(cudaDevAttrClockRate);                                // kHz
  timed.device_bytes_per_s = 2e3 * properties.memoryBusWidth / 8 * attribute(cudaDevAttrMemoryClockRate);  // kHz
  return timed;
}

std::unique_ptr<ResidentVoters> make_resident_voters(const CellGrid& grid, const kernels::Decay& decay) {
  return std::make_unique<ResidentVotersOn<CudaMachine>>(CudaMachine(), grid, decay);
}

}  // namespace curbstone::tensor_voting::cuda
