#pragma once

#include <cmath>
#include <cstdint>

#include "tools/simulate/numerics/random.hpp"

namespace curbstone::simulate::paint {

/// 0..1, the value of a raster cell; `kind` distinguishes textures.
[[nodiscard]] inline float cell_value(int ix, int iy, std::uint64_t kind) {
  const auto key = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(ix)) << 32) | static_cast<std::uint32_t>(iy);
  return static_cast<float>(numerics::mix_bits(key ^ (kind * 0x9e3779b97f4a7c15ULL)) >> 40) * (1.0F / 16777216.0F);
}

/// Value noise over the plane: 0..1, mean 1/2, bilinear between nodes `pitch` m apart.
[[nodiscard]] inline float speckle(float x, float y, float pitch, std::uint64_t kind) {
  const float u = x / pitch, v = y / pitch;
  const float bu = std::floor(u), bv = std::floor(v);
  const int iu = static_cast<int>(bu), iv = static_cast<int>(bv);
  const float fu = u - bu, fv = v - bv;
  const float low = cell_value(iu, iv, kind) * (1 - fu) + cell_value(iu + 1, iv, kind) * fu;
  const float high = cell_value(iu, iv + 1, kind) * (1 - fu) + cell_value(iu + 1, iv + 1, kind) * fu;
  return low * (1 - fv) + high * fv;
}

}  // namespace curbstone::simulate::paint
