#pragma once

#include <cuda_runtime_api.h>

#include <cstddef>
#include <cstdint>

namespace curbstone::tensor_voting::cuda {

/// CUB's radix sort, compiled on its own: it takes longer than all the rest. Stable. With temporary == nullptr, only
/// sets `bytes` to what it needs there.
cudaError_t sort_on_device(void* temporary, std::size_t& bytes, const std::uint64_t* keys, std::uint64_t* sorted_keys,
                           const std::uint32_t* values, std::uint32_t* sorted_values, std::uint32_t n,
                           cudaStream_t stream);

}  // namespace curbstone::tensor_voting::cuda
