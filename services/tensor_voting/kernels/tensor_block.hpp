#pragma once

#include <cstddef>
#include <span>

#include "services/tensor_voting/kernels/decomposition.hpp"
#include "services/tensor_voting/kernels/tensor.hpp"
#include "services/tensor_voting/kernels/vote_kernel.hpp"

namespace curbstone::tensor_voting::kernels {

/// kLanes tensors side by side, component after component, in the layout of VoteKernel::decompose.
struct TensorBlock {
  float component[6 * kLanes];  ///< xx xy xz yy yz zz
  float mass[kLanes];

  void set(std::size_t lane, const TensorF& t) {
    const float components[] = {t.xx, t.xy, t.xz, t.yy, t.yz, t.zz};
    for (std::size_t c = 0; c < 6; ++c) component[c * kLanes + lane] = components[c];
    mass[lane] = t.mass;
  }
  [[nodiscard]] TensorF get(std::size_t lane) const {
    const auto at = [&](std::size_t c) { return component[c * kLanes + lane]; };
    return {at(0), at(1), at(2), at(3), at(4), at(5), mass[lane]};
  }
};
static_assert(sizeof(TensorBlock) == kTensorFloats * sizeof(float));

/// The decompositions of a TensorBlock.
struct ShapeBlock {
  float component[9 * kLanes];  ///< normal, tangent, stick, plate, ball

  [[nodiscard]] DecompositionF get(std::size_t lane, float mass) const {
    const auto at = [&](std::size_t c) { return component[c * kLanes + lane]; };
    return {{at(0), at(1), at(2)}, {at(3), at(4), at(5)}, at(6), at(7), at(8), mass};
  }
};
static_assert(sizeof(ShapeBlock) == kShapeFloats * sizeof(float));

/// Decomposes tensors: shapes[i] of tensors[i].
inline void decompose(std::span<const TensorBlock> tensors, std::span<ShapeBlock> shapes,
                      const VoteKernel& kernel = vote_kernels()[0]) {
  if (tensors.empty()) return;
  kernel.decompose(tensors[0].component, shapes[0].component, tensors.size());
}

}  // namespace curbstone::tensor_voting::kernels
