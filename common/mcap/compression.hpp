#pragma once

#include <string>
#include <string_view>

namespace curbstone {

/// How the chunks of an MCAP file are packed.
enum class McapCompression { kNone, kZstd };

/// The name of the compression in the file: "" or "zstd".
[[nodiscard]] std::string_view name_of(McapCompression compression);
/// Throws std::runtime_error when out of memory.
[[nodiscard]] std::string compress(McapCompression compression, std::string_view bytes);

}  // namespace curbstone
