#include "services/tensor_voting/cuda/device_sort.hpp"

#include <cub/device/device_radix_sort.cuh>

namespace curbstone::tensor_voting::cuda {

cudaError_t sort_on_device(void* temporary, std::size_t& bytes, const std::uint64_t* keys, std::uint64_t* sorted_keys,
                           const std::uint32_t* values, std::uint32_t* sorted_values, std::uint32_t n,
                           cudaStream_t stream) {
  return cub::DeviceRadixSort::SortPairs(temporary, bytes, keys, sorted_keys, values, sorted_values, n, 0, 64, stream);
}

}  // namespace curbstone::tensor_voting::cuda
