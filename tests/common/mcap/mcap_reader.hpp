#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace curbstone::test {

/// Reads a whole MCAP file strictly by https://mcap.dev/spec, and by nothing of the writer. Whatever does not agree, a
/// checksum, an index, a count, is a line in `errors`.
struct McapFile {
  struct Schema {
    std::string name, encoding, data;
  };
  struct Channel {
    std::uint16_t schema = 0;
    std::string topic = {}, encoding = {};
  };
  struct Message {
    std::uint16_t channel = 0;
    std::uint32_t sequence = 0;
    std::uint64_t log_time = 0, publish_time = 0;
    std::string data = {};
  };
  std::string library;
  std::map<std::uint16_t, Schema> schemas;
  std::map<std::uint16_t, Channel> channels;
  std::vector<Message> messages;  ///< as they stand in the file
  std::size_t chunks = 0;
  std::vector<std::string> errors;

  /// Data of the messages of one topic.
  [[nodiscard]] std::vector<std::string> of(std::string_view topic) const {
    std::vector<std::string> found;
    for (const Message& message : messages)
      if (channels.at(message.channel).topic == topic) found.push_back(message.data);
    return found;
  }
};

[[nodiscard]] McapFile read_mcap(const std::string& bytes);

}  // namespace curbstone::test
