#pragma once

#include <cstdint>
#include <iosfwd>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/mcap/compression.hpp"
#include "common/mcap/record_bytes.hpp"

namespace curbstone {

struct McapOptions {
  McapCompression compression = McapCompression::kZstd;
  std::size_t chunk_bytes = std::size_t{4} << 20;  ///< of records, before compression; one large message may exceed it
  std::string library = "curbstone";               ///< name of the writing library
};

/// The schema of a channel's messages.
struct McapSchema {
  std::string name;      ///< "foxglove.Grid"
  std::string encoding;  ///< "protobuf", "jsonschema", ...
  std::string data;
};

/// Writes an MCAP file: chunks with their indexes, checksums on all parts, and a summary at the end, so that a viewer
/// finds any time without reading the whole file. Memory holds one chunk, and for each earlier chunk 60 bytes plus 10
/// for each channel. The bytes written are a function of the calls alone. Format: https://mcap.dev/spec. One thread.
class McapWriter {
 public:
  /// Writes to `out`, which must outlive this object. All functions throw std::runtime_error when `out` fails.
  McapWriter(std::ostream& out, McapOptions options);

  /// Returns the id, from 1. At most 65535.
  std::uint16_t add_schema(McapSchema schema);
  /// `schema` 0: no schema. Returns the id, from 0. At most 65536.
  std::uint16_t add_channel(const std::string& topic, const std::string& message_encoding, std::uint16_t schema);

  /// Times in ns since the Unix epoch: `log_time` is the time by which a viewer plays, `publish_time` the message's
  /// own. `channel` is an id returned by add_channel().
  void write(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time, std::string_view data);
  /// Ends the file. Call it once; nothing may be written afterwards.
  void finish();

  [[nodiscard]] std::uint64_t messages() const { return messages_; }
  [[nodiscard]] std::uint64_t bytes() const { return offset_; }

 private:
  struct Channel {
    std::string topic;
    std::string encoding;
    std::uint16_t schema = 0;
    std::uint64_t messages = 0;
    bool in_data = false;  // its channel record is in a chunk
    RecordBytes index;     // of the open chunk: (time, offset)
  };
  struct Schema {
    McapSchema schema;
    bool in_data = false;
  };
  struct Span {
    std::uint64_t start = 0;
    std::uint64_t end = 0;
    bool empty = true;
    void include(std::uint64_t time);
  };
  struct Chunk {
    Span times;
    std::uint64_t offset = 0;
    std::uint64_t length = 0;  // of the record, with its header
    std::uint64_t index_length = 0;
    std::uint64_t packed_size = 0;
    std::uint64_t size = 0;
    RecordBytes indexes;  // (channel, offset)
  };
  void introduce(std::uint16_t channel);
  void close_chunk();
  void put(std::string_view bytes);
  [[nodiscard]] static RecordBytes schema_record(std::uint16_t id, const McapSchema& schema);
  [[nodiscard]] static RecordBytes channel_record(std::uint16_t id, const Channel& channel);
  [[nodiscard]] RecordBytes statistics_record() const;
  [[nodiscard]] RecordBytes chunk_index_record(const Chunk& chunk) const;
  void write_summary();

  std::ostream& out_;
  McapOptions options_;
  std::vector<Schema> schemas_;
  std::vector<Channel> channels_;
  std::vector<Chunk> chunks_;
  RecordBytes records_;  // of the open chunk
  Span chunk_times_;
  Span times_;
  std::uint64_t messages_ = 0;
  std::uint64_t offset_ = 0;
  std::uint32_t crc_ = 0;  // of everything put since it was set to 0
};

}  // namespace curbstone
