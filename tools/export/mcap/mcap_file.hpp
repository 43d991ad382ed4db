#pragma once

#include <cstdint>
#include <string>

#include "common/mcap/compression.hpp"
#include "services/viewer/viewer_config.hpp"

namespace curbstone::map_export::mcap {

struct McapSettings {
  McapCompression compression = McapCompression::kZstd;
  bool raw = true;  ///< the log's own messages, too
};

struct McapResult {
  std::uint64_t messages = 0;
  bool has_map = false;         ///< else the log holds no products of the mapper and of semantic_map
  std::int64_t refused = 0;     ///< messages that are not sound: not shown, though raw ones are in the file
  std::int64_t left_out = 0;    ///< raw messages of more channels than kMaxRawChannels
  bool log_is_damaged = false;  ///< parts of the log could not be read
};

inline constexpr std::size_t kMaxRawChannels = 1000;

/// Writes `log` (a file, or a folder of them) as MCAP to `path`: what Foxglove's panels show, and the messages as they
/// were on the bus. A message's log time is the record's, its publish time its own. Throws std::runtime_error with one
/// clear line.
McapResult write_mcap(const std::string& log, const std::string& path, const viewer::ViewerConfig& config,
                      const McapSettings& settings);

}  // namespace curbstone::map_export::mcap
