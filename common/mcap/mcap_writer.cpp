#include "common/mcap/mcap_writer.hpp"

#include <zlib.h>

#include <algorithm>
#include <ostream>
#include <stdexcept>
#include <utility>

namespace curbstone {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);

std::uint32_t crc_of(std::uint32_t crc, std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace

void McapWriter::Span::include(std::uint64_t time) {
  start = empty ? time : std::min(start, time);
  end = empty ? time : std::max(end, time);
  empty = false;
}

McapWriter::McapWriter(std::ostream& out, McapOptions options) : out_(out), options_(std::move(options)) {
  put(kMagic);
  RecordBytes header;
  header.text("").text(options_.library);
  put(RecordBytes().record(McapRecord::kHeader, header).bytes());
}

std::uint16_t McapWriter::add_schema(McapSchema schema) {
  if (schemas_.size() >= 65535) throw std::runtime_error("MCAP: more than 65535 schemas");
  schemas_.push_back({std::move(schema), false});
  return static_cast<std::uint16_t>(schemas_.size());
}

std::uint16_t McapWriter::add_channel(const std::string& topic, const std::string& message_encoding,
                                      std::uint16_t schema) {
  if (channels_.size() >= 65536) throw std::runtime_error("MCAP: more than 65536 channels");
  if (schema > schemas_.size()) throw std::runtime_error("MCAP: channel " + topic + " has a schema that is not there");
  channels_.push_back({topic, message_encoding, schema, 0, false, {}});
  return static_cast<std::uint16_t>(channels_.size() - 1);
}

void McapWriter::write(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time,
                       std::string_view data) {
  introduce(channel);
  Channel& to = channels_.at(channel);
  to.index.number(log_time).number(std::uint64_t{records_.size()});
  records_.head(McapRecord::kMessage, 22 + data.size())
      .number(channel)
      .number(static_cast<std::uint32_t>(to.messages))
      .number(log_time)
      .number(publish_time)
      .raw(data);
  ++to.messages;
  ++messages_;
  chunk_times_.include(log_time);
  times_.include(log_time);
  if (records_.size() >= options_.chunk_bytes) close_chunk();
}

/// Writes a channel's record before its first message, and the record of its schema before that.
void McapWriter::introduce(std::uint16_t channel) {
  Channel& known = channels_.at(channel);
  if (known.in_data) return;
  if (known.schema != 0 && !schemas_[known.schema - 1U].in_data) {
    records_.raw(schema_record(known.schema, schemas_[known.schema - 1U].schema).bytes());
    schemas_[known.schema - 1U].in_data = true;
  }
  records_.raw(channel_record(channel, known).bytes());
  known.in_data = true;
}

void McapWriter::close_chunk() {
  if (records_.size() == 0) return;
  const std::string packed = compress(options_.compression, records_.bytes());
  Chunk chunk{
      .times = chunk_times_, .offset = offset_, .packed_size = packed.size(), .size = records_.size(), .indexes = {}};
  RecordBytes fields;
  fields.number(chunk.times.start)
      .number(chunk.times.end)
      .number(chunk.size)
      .number(crc_of(0, records_.bytes()))
      .text(name_of(options_.compression))
      .number(chunk.packed_size);
  put(RecordBytes().head(McapRecord::kChunk, fields.size() + packed.size()).raw(fields.bytes()).bytes());
  put(packed);
  chunk.length = offset_ - chunk.offset;
  const std::uint64_t indexes = offset_;
  for (std::size_t id = 0; id < channels_.size(); ++id) {
    RecordBytes& index = channels_[id].index;
    if (index.size() == 0) continue;
    chunk.indexes.number(static_cast<std::uint16_t>(id)).number(offset_);
    RecordBytes content;
    content.number(static_cast<std::uint16_t>(id)).text(index.bytes());
    put(RecordBytes().record(McapRecord::kMessageIndex, content).bytes());
    index.clear();
  }
  chunk.index_length = offset_ - indexes;
  chunks_.push_back(std::move(chunk));
  records_.clear();
  chunk_times_ = {};
}

void McapWriter::finish() {
  close_chunk();
  RecordBytes data_end;
  data_end.number(crc_);
  put(RecordBytes().record(McapRecord::kDataEnd, data_end).bytes());
  write_summary();
  put(kMagic);
  out_.flush();
  if (!out_) throw std::runtime_error("MCAP: cannot be written");
}

void McapWriter::write_summary() {
  const std::uint64_t start = offset_;
  crc_ = 0;
  RecordBytes offsets;
  const auto group = [&](McapRecord kind, const RecordBytes& records) {
    if (records.size() == 0) return;
    RecordBytes place;
    place.number(static_cast<std::uint8_t>(kind)).number(offset_).number(std::uint64_t{records.size()});
    offsets.record(McapRecord::kSummaryOffset, place);
    put(records.bytes());
  };
  RecordBytes schemas;
  for (std::size_t i = 0; i < schemas_.size(); ++i)
    if (schemas_[i].in_data) schemas.raw(schema_record(static_cast<std::uint16_t>(i + 1), schemas_[i].schema).bytes());
  RecordBytes channels;
  for (std::size_t i = 0; i < channels_.size(); ++i)
    if (channels_[i].in_data) channels.raw(channel_record(static_cast<std::uint16_t>(i), channels_[i]).bytes());
  RecordBytes chunks;
  for (const Chunk& chunk : chunks_) chunks.raw(chunk_index_record(chunk).bytes());
  group(McapRecord::kSchema, schemas);
  group(McapRecord::kChannel, channels);
  group(McapRecord::kStatistics, statistics_record());
  group(McapRecord::kChunkIndex, chunks);
  const std::uint64_t offset_start = offset_;
  put(offsets.bytes());
  put(RecordBytes().head(McapRecord::kFooter, 20).number(start).number(offset_start).bytes());
  put(RecordBytes().number(crc_).bytes());
}

RecordBytes McapWriter::schema_record(std::uint16_t id, const McapSchema& schema) {
  RecordBytes content;
  content.number(id).text(schema.name).text(schema.encoding).text(schema.data);
  return std::move(RecordBytes().record(McapRecord::kSchema, content));
}

RecordBytes McapWriter::channel_record(std::uint16_t id, const Channel& channel) {
  RecordBytes content;
  content.number(id).number(channel.schema).text(channel.topic).text(channel.encoding).text("");
  return std::move(RecordBytes().record(McapRecord::kChannel, content));
}

RecordBytes McapWriter::statistics_record() const {
  std::uint16_t schemas = 0;
  std::uint32_t channels = 0;
  RecordBytes counts;
  for (const Schema& schema : schemas_) schemas = static_cast<std::uint16_t>(schemas + (schema.in_data ? 1 : 0));
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (!channels_[i].in_data) continue;
    ++channels;
    counts.number(static_cast<std::uint16_t>(i)).number(channels_[i].messages);
  }
  constexpr std::uint32_t kNone = 0;
  RecordBytes content;
  content.number(messages_)
      .number(schemas)
      .number(channels)
      .number(kNone)  // attachments
      .number(kNone)  // metadata
      .number(static_cast<std::uint32_t>(chunks_.size()))
      .number(times_.start)
      .number(times_.end)
      .text(counts.bytes());
  return std::move(RecordBytes().record(McapRecord::kStatistics, content));
}

RecordBytes McapWriter::chunk_index_record(const Chunk& chunk) const {
  RecordBytes content;
  content.number(chunk.times.start)
      .number(chunk.times.end)
      .number(chunk.offset)
      .number(chunk.length)
      .text(chunk.indexes.bytes())
      .number(chunk.index_length)
      .text(name_of(options_.compression))
      .number(chunk.packed_size)
      .number(chunk.size);
  return std::move(RecordBytes().record(McapRecord::kChunkIndex, content));
}

void McapWriter::put(std::string_view bytes) {
  crc_ = crc_of(crc_, bytes);
  offset_ += bytes.size();
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!out_) throw std::runtime_error("MCAP: cannot be written");
}

}  // namespace curbstone
