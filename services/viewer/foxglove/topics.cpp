#include "services/viewer/foxglove/topics.hpp"

#include <foxglove/frames.pb.h>
#include <foxglove/log.pb.h>
#include <foxglove/packed.pb.h>
#include <foxglove/scene.pb.h>
#include <google/protobuf/descriptor.pb.h>

#include <set>

namespace curbstone::viewer::foxglove {
namespace {

using google::protobuf::FileDescriptor;
using google::protobuf::FileDescriptorSet;

constexpr const char* kStatusSchema =
    R"({"type":"object","title":"curbstone.ServiceStatus","properties":{)"
    R"("utime":{"type":"integer","description":"us since the Unix epoch"},"host":{"type":"string"},)"
    R"("pid":{"type":"integer"},"version":{"type":"string"},"uptime":{"type":"number","description":"s"},)"
    R"("cpu":{"type":"number","description":"cores"},"memory":{"type":"integer","description":"bytes"},)"
    R"("latency_p50":{"type":"number","description":"s"},"latency_p99":{"type":"number","description":"s"},)"
    R"("counters":{"type":"object","additionalProperties":{"type":"integer"}},)"
    R"("faults":{"type":"array","items":{"type":"string"}}}})";

/// Adds a file after its imports.
void add_file(const FileDescriptor& file, std::set<std::string>& added, FileDescriptorSet& set) {
  if (!added.insert(file.name()).second) return;
  for (int i = 0; i < file.dependency_count(); ++i) add_file(*file.dependency(i), added, set);
  file.CopyTo(set.add_file());
}

template <class Message>
Channel channel_of(Topic id, const std::string& topic) {
  std::set<std::string> added;
  FileDescriptorSet set;
  add_file(*Message::descriptor()->file(), added, set);
  return {id, topic, "protobuf", Message::descriptor()->full_name(), "protobuf", set.SerializeAsString()};
}

std::vector<Channel> make_channels() {
  return {channel_of<::foxglove::FrameTransforms>(kTransforms, "/tf"),
          channel_of<::foxglove::PoseInFrame>(kPose, "/pose"),
          channel_of<::foxglove::Grid>(kMapWindow, "/map/window"),
          channel_of<::foxglove::Grid>(kMapWhole, "/map/whole"),
          channel_of<::foxglove::SceneUpdate>(kCurbs, "/curbs"),
          channel_of<::foxglove::SceneUpdate>(kPath, "/path"),
          channel_of<::foxglove::PointCloud>(kScan, "/lidar"),
          channel_of<::foxglove::PointCloud>(kPoints, "/map/points"),
          channel_of<::foxglove::Log>(kLog, "/log"),
          channel_of<::foxglove::SceneUpdate>(kMarkings, "/markings")};
}

}  // namespace

const std::vector<Channel>& fixed_channels() {
  static const std::vector<Channel> channels = make_channels();
  return channels;
}

Channel status_channel(std::size_t index, const std::string& topic) {
  return {kFirstStatus + static_cast<std::uint32_t>(index),
          topic,
          "json",
          "curbstone.ServiceStatus",
          "jsonschema",
          kStatusSchema};
}

}  // namespace curbstone::viewer::foxglove
