#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace curbstone::viewer::foxglove {

/// What is shown. A process's status has the channels from kFirstStatus on, in the order of StatusBook::services().
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

/// A topic, as a server advertises it and a file lists it.
struct Channel {
  std::uint32_t id = 0;  ///< a Topic
  std::string topic;
  std::string encoding;         ///< of the messages: "protobuf", "json"
  std::string schema_name;      ///< "foxglove.Grid"
  std::string schema_encoding;  ///< "protobuf", "jsonschema"
  std::string schema;           ///< a FileDescriptorSet with all that is imported, or a JSON schema
};

/// All but the processes' status.
[[nodiscard]] const std::vector<Channel>& fixed_channels();
/// `index` in StatusBook::services().
[[nodiscard]] Channel status_channel(std::size_t index, const std::string& topic);

}  // namespace curbstone::viewer::foxglove
