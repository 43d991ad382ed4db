#pragma once

#include <cuda_runtime_api.h>

#include <cstddef>
#include <cstdint>

namespace curbstone::tensor_voting::cuda {

/// CUB's radix sort, in a file of its own because it takes longer to compile than everything else. Stable. With
/// temporary == nullptr, only sets `bytes` to the size that it needs.
cudaError_t sort_on_device(void* temporary, std::size_t& bytes, const std::uint64_t* keys, std::uint64_t* sorted_keys,
                           const std::uint32_t* values, std::uint32_t* sorted_values, std::uint32_t n,
                           cudaStream_t stream);

}  // namespace curbstone::tensor_voting::cuda
