#include "common/mcap/compression.hpp"

#include <zstd.h>

#include <stdexcept>

namespace curbstone {
namespace {

/// The fastest level: a log is written once, on the computer that drives the vehicle.
constexpr int kLevel = 1;

}  // namespace

std::string_view name_of(McapCompression compression) {
  return compression == McapCompression::kZstd ? "zstd" : "";
}

std::string compress(McapCompression compression, std::string_view bytes) {
  if (compression == McapCompression::kNone) return std::string(bytes);
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kLevel);
  if (ZSTD_isError(size) != 0) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(size));
  packed.resize(size);
  return packed;
}

}  // namespace curbstone
