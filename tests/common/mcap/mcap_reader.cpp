#include "tests/common/mcap/mcap_reader.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <set>
#include <stdexcept>

namespace curbstone::test {
namespace {

const std::string kMagic = "\x89MCAP0\r\n";

std::uint32_t crc(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// Throws std::out_of_range at the end of the bytes.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes) : bytes_(bytes) {}
  template <class Number>
  Number number() {
    Number value{};
    std::memcpy(&value, take(sizeof value).data(), sizeof value);  // a little-endian machine
    return value;
  }
  std::string_view take(std::uint64_t size) {
    if (size > bytes_.size()) throw std::out_of_range("cut off");
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }
  std::string_view text() { return take(number<std::uint32_t>()); }
  [[nodiscard]] bool done() const { return bytes_.empty(); }
  [[nodiscard]] std::size_t left() const { return bytes_.size(); }

 private:
  std::string_view bytes_;
};

struct ChunkSeen {
  std::uint64_t offset = 0, length = 0, start = 0, end = 0, packed = 0, size = 0;
  std::string compression = {};
  std::map<std::uint16_t, std::uint64_t> indexes = {};  // where they stand
  std::uint64_t index_length = 0;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> messages = {};  // time, offset
  bool operator==(const ChunkSeen& o) const {
    return offset == o.offset && length == o.length && start == o.start && end == o.end && packed == o.packed &&
           size == o.size && compression == o.compression && indexes == o.indexes && index_length == o.index_length;
  }
};

class Reader {
 public:
  Reader(const std::string& bytes, McapFile& file) : bytes_(bytes), file_(file) {}

  void read() {
    const auto all = std::string_view(bytes_);
    expect(all.substr(0, 8) == kMagic && all.substr(all.size() - 8) == kMagic, "magic");
    std::uint64_t at = 8;
    while (at < all.size() - 8) at += record(at, all.substr(at, all.size() - 8 - at));
    expect(chunk_indexes_.size() == chunks_.size(), "a chunk without index");
    for (std::size_t i = 0; i < std::min(chunks_.size(), chunk_indexes_.size()); ++i)
      expect(chunk_indexes_[i] == chunks_[i], "chunk index");
    expect(statistics_ && footer_ && data_end_ > 0, "statistics, footer or data end");
    file_.chunks = chunks_.size();
  }

 private:
  void expect(bool holds, const std::string& what) {
    if (!holds) file_.errors.push_back(what);
  }

  /// Returns its size.
  std::uint64_t record(std::uint64_t at, std::string_view bytes) {
    Cursor head(bytes);
    const auto kind = head.number<std::uint8_t>();
    const auto length = head.number<std::uint64_t>();
    Cursor in(head.take(length));
    kinds_.push_back(kind);
    expect(kind == 1 || at > 8, "the header is not first");
    if (kind == 1) {
      in.text();
      file_.library = in.text();
    } else if (kind == 2) {
      footer(at, in);
    } else if (kind == 3 || kind == 4) {
      definition(kind, in, true);
    } else if (kind == 6) {
      chunk(at, length + 9, in);
    } else if (kind == 7) {
      message_index(at, length + 9, in);
    } else if (kind == 8) {
      chunk_index(in);
    } else if (kind == 11) {
      statistics(in);
    } else if (kind == 14) {
      summary_offset(in);
    } else if (kind == 15) {
      expect(in.number<std::uint32_t>() == crc(std::string_view(bytes_).substr(0, at)), "data crc");
      data_end_ = at + length + 9;
    } else {
      expect(false, "a record of kind " + std::to_string(kind));
    }
    expect(in.done(), "bytes left in a record of kind " + std::to_string(kind));
    return length + 9;
  }

  void definition(std::uint8_t kind, Cursor& in, bool in_summary) {
    const auto id = in.number<std::uint16_t>();
    if (kind == 3) {
      const std::string name(in.text());
      const std::string encoding(in.text());
      const McapFile::Schema schema{name, encoding, std::string(in.text())};
      expect(id != 0, "schema 0");
      expect(!in_summary || file_.schemas.contains(id), "a schema of the summary alone");
      file_.schemas[id] = schema;
      return;
    }
    McapFile::Channel channel{.schema = in.number<std::uint16_t>()};
    channel.topic = in.text();
    channel.encoding = in.text();
    in.text();  // metadata
    expect(channel.schema == 0 || file_.schemas.contains(channel.schema), "a channel before its schema");
    expect(!in_summary || file_.channels.contains(id), "a channel of the summary alone");
    file_.channels[id] = channel;
  }

  void chunk(std::uint64_t at, std::uint64_t length, Cursor& in) {
    expect(data_end_ == 0, "a chunk behind the data");
    ChunkSeen seen{.offset = at, .length = length};
    seen.start = in.number<std::uint64_t>();
    seen.end = in.number<std::uint64_t>();
    seen.size = in.number<std::uint64_t>();
    const auto sum = in.number<std::uint32_t>();
    seen.compression = in.text();
    seen.packed = in.number<std::uint64_t>();
    std::string records(in.take(seen.packed));
    if (seen.compression == "zstd") {
      std::string raw(seen.size, '\0');
      const std::size_t n = ZSTD_decompress(raw.data(), raw.size(), records.data(), records.size());
      expect(ZSTD_isError(n) == 0 && n == seen.size, "zstd");
      records = raw;
    } else {
      expect(seen.compression.empty(), "compression " + seen.compression);
    }
    expect(crc(records) == sum, "chunk crc");
    std::uint64_t low = UINT64_MAX;
    std::uint64_t high = 0;
    Cursor all(records);
    while (!all.done()) {
      const std::uint64_t offset = records.size() - all.left();
      const auto kind = all.number<std::uint8_t>();
      Cursor one(all.take(all.number<std::uint64_t>()));
      if (kind != 5) {
        expect(kind == 3 || kind == 4, "a chunk holds kind " + std::to_string(kind));
        definition(kind, one, false);
        continue;
      }
      McapFile::Message message{.channel = one.number<std::uint16_t>()};
      message.sequence = one.number<std::uint32_t>();
      message.log_time = one.number<std::uint64_t>();
      message.publish_time = one.number<std::uint64_t>();
      message.data = one.take(one.left());
      expect(file_.channels.contains(message.channel), "a message before its channel");
      low = std::min(low, message.log_time);
      high = std::max(high, message.log_time);
      seen.messages[message.channel].emplace_back(message.log_time, offset);
      file_.messages.push_back(message);
    }
    expect(low == seen.start && high == seen.end, "the times of a chunk");
    chunks_.push_back(seen);
  }

  void message_index(std::uint64_t at, std::uint64_t length, Cursor& in) {
    ChunkSeen& chunk = chunks_.at(chunks_.size() - 1);
    const auto channel = in.number<std::uint16_t>();
    Cursor list(in.text());
    std::vector<std::pair<std::uint64_t, std::uint64_t>> entries;
    while (!list.done()) {
      const auto time = list.number<std::uint64_t>();
      entries.emplace_back(time, list.number<std::uint64_t>());
    }
    expect(entries == chunk.messages[channel], "message index");
    chunk.indexes[channel] = at;
    chunk.index_length += length;
  }

  void chunk_index(Cursor& in) {
    ChunkSeen index;
    index.start = in.number<std::uint64_t>();
    index.end = in.number<std::uint64_t>();
    index.offset = in.number<std::uint64_t>();
    index.length = in.number<std::uint64_t>();
    Cursor list(in.text());
    while (!list.done()) {
      const auto channel = list.number<std::uint16_t>();
      index.indexes[channel] = list.number<std::uint64_t>();
    }
    index.index_length = in.number<std::uint64_t>();
    index.compression = in.text();
    index.packed = in.number<std::uint64_t>();
    index.size = in.number<std::uint64_t>();
    chunk_indexes_.push_back(index);
  }

  void statistics(Cursor& in) {
    statistics_ = true;
    expect(in.number<std::uint64_t>() == file_.messages.size(), "count of messages");
    expect(in.number<std::uint16_t>() == file_.schemas.size(), "count of schemas");
    expect(in.number<std::uint32_t>() == file_.channels.size(), "count of channels");
    expect(in.number<std::uint32_t>() == 0 && in.number<std::uint32_t>() == 0, "attachments");
    expect(in.number<std::uint32_t>() == chunks_.size(), "count of chunks");
    std::uint64_t low = file_.messages.empty() ? 0 : UINT64_MAX;
    std::uint64_t high = 0;
    std::map<std::uint16_t, std::uint64_t> counts;
    for (const auto& message : file_.messages) {
      low = std::min(low, message.log_time);
      high = std::max(high, message.log_time);
      expect(message.sequence == counts[message.channel], "sequence");
      ++counts[message.channel];
    }
    expect(in.number<std::uint64_t>() == low && in.number<std::uint64_t>() == high, "times");
    Cursor list(in.text());
    while (!list.done()) {
      const auto channel = list.number<std::uint16_t>();
      expect(list.number<std::uint64_t>() == counts[channel], "messages of a channel");
    }
  }

  /// A group of the summary holds records of its kind alone, and ends where it says.
  void summary_offset(Cursor& in) {
    const auto kind = in.number<std::uint8_t>();
    const auto start = in.number<std::uint64_t>();
    Cursor group(std::string_view(bytes_).substr(start, in.number<std::uint64_t>()));
    while (!group.done()) {
      expect(group.number<std::uint8_t>() == kind, "group of the summary");
      group.take(group.number<std::uint64_t>());
    }
  }

  void footer(std::uint64_t at, Cursor& in) {
    footer_ = true;
    const auto start = in.number<std::uint64_t>();
    const auto offsets = in.number<std::uint64_t>();
    expect(start == data_end_, "start of the summary");
    expect(offsets < at && bytes_[offsets] == 14, "start of the summary's offsets");
    expect(in.number<std::uint32_t>() == crc(std::string_view(bytes_).substr(start, at + 25 - start)), "summary crc");
    expect(at + 29 + 8 == bytes_.size(), "the footer is not last");
  }

  const std::string& bytes_;
  McapFile& file_;
  std::vector<std::uint8_t> kinds_;
  std::vector<ChunkSeen> chunks_;
  std::vector<ChunkSeen> chunk_indexes_;
  std::uint64_t data_end_ = 0;
  bool statistics_ = false;
  bool footer_ = false;
};

}  // namespace

McapFile read_mcap(const std::string& bytes) {
  McapFile file;
  try {
    if (bytes.size() < 16) throw std::out_of_range("shorter than its magic");
    Reader(bytes, file).read();
  } catch (const std::out_of_range& error) {
    file.errors.emplace_back(error.what());
  }
  return file;
}

}  // namespace curbstone::test
