#pragma once

#include <string>
#include <string_view>

namespace curbstone {

/// How the chunks of an MCAP file are packed.
enum class McapCompression { kNone, kZstd };

/// As the file names it: "" or "zstd".
[[nodiscard]] std::string_view name_of(McapCompression compression);
/// Throws std::runtime_error when memory ends.
[[nodiscard]] std::string compress(McapCompression compression, std::string_view bytes);

}  // namespace curbstone
