#pragma once

#include <cstdint>
#include <string>

#include "common/mcap/compression.hpp"
#include "services/viewer/viewer_config.hpp"

namespace curbstone::map_export::mcap {

struct McapSettings {
  McapCompression compression = McapCompression::kZstd;
  bool raw = true;  ///< includes the log's own messages
};

struct McapResult {
  std::uint64_t messages = 0;
  bool has_map = false;         ///< false: the log has no output of the mapper and of semantic_map
  std::int64_t refused = 0;     ///< invalid messages: not shown, although the raw ones are in the file
  std::int64_t left_out = 0;    ///< raw messages of channels beyond kMaxRawChannels
  bool log_is_damaged = false;  ///< parts of the log could not be read
};

inline constexpr std::size_t kMaxRawChannels = 1000;

/// Writes `log` (a file, or a folder of them) as MCAP to `path`: the messages for Foxglove's panels, and the messages
/// as they were on the bus. A message's log time is that of the record, its publish time is its own. Throws
/// std::runtime_error with a one-line message.
McapResult write_mcap(const std::string& log, const std::string& path, const viewer::ViewerConfig& config,
                      const McapSettings& settings);

}  // namespace curbstone::map_export::mcap
