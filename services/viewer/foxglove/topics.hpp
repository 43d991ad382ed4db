#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace curbstone::viewer::foxglove {

/// The channels. The status of a process has a channel from kFirstStatus on, in the order of StatusHistory::services().
enum Topic : std::uint32_t {
  kTransforms = 1,
  kPose,
  kMapWindow,
  kMapWhole,
  kCurbs,
  kPath,
  kScan,
  kPoints,
  kLog,
  kMarkings,
  kFirstStatus = 100,
};

/// A channel as a server advertises it and a file lists it.
struct Channel {
  std::uint32_t id = 0;  ///< a Topic
  std::string topic;
  std::string encoding;         ///< of the messages: "protobuf", "json"
  std::string schema_name;      ///< "foxglove.Grid"
  std::string schema_encoding;  ///< "protobuf", "jsonschema"
  std::string schema;           ///< a FileDescriptorSet with all imports, or a JSON schema
};

/// All channels but those of the processes' status.
[[nodiscard]] const std::vector<Channel>& fixed_channels();
/// `index`: in StatusHistory::services().
[[nodiscard]] Channel status_channel(std::size_t index, const std::string& topic);

}  // namespace curbstone::viewer::foxglove
