#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "common/mcap/mcap_writer.hpp"

namespace curbstone::map_export::mcap {

/// The schemas of our LCM messages for files that hold them: encoding "lcm", data is the text of the type's .lcm file
/// followed by those of its nested types. (MCAP's registry has no name for LCM.)
class LcmSchemas {
 public:
  LcmSchemas();
  /// Finds the schema by the first eight bytes of a message. Empty: not one of our types.
  [[nodiscard]] std::optional<McapSchema> of(const void* message, std::size_t size) const;

 private:
  std::map<std::string, std::string> texts_;  // by type
};

}  // namespace curbstone::map_export::mcap
