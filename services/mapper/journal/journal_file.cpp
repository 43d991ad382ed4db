#include "services/mapper/journal/journal_file.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>
#include <vector>

#include "services/mapper/journal/journal_codec.hpp"

namespace curbstone::mapper::journal {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSpillInterval = 4'000'000;     // bytes that are read between two spills
constexpr std::size_t kMaxRecordsInMemory = 400'000;  // that stay in memory: 3 MB
constexpr std::uint32_t kBatchMagic = 0x314c4a43;     // "CJL1"

struct BatchHead {
  std::uint32_t magic = kBatchMagic;
  std::uint32_t checksum = 0;  // of size and items
  std::uint64_t size = 0;      // bytes of items
};

std::uint32_t checksum_of(std::uint64_t size, std::string_view items) {
  const uLong seed = crc32_z(0, reinterpret_cast<const Bytef*>(&size), sizeof size);
  return static_cast<std::uint32_t>(crc32_z(seed, reinterpret_cast<const Bytef*>(items.data()), items.size()));
}

/// Spills parts of a drive while it is read.
class DriveSpiller {
 public:
  explicit DriveSpiller(SpillFile& spill_file) : spill_file_(spill_file) {}
  /// Spills all but so many records, keeping the tiles that grew last: the vehicle has left the others.
  void spill(RecordedDrive& drive, std::size_t most_records) {
    for (; nodes_ < drive.nodes.size(); ++nodes_) drive.nodes[nodes_].kept.points.spill(spill_file_);
    std::vector<std::pair<std::size_t, RecordedTile*>> here;
    std::size_t records = 0;
    for (auto& [key, tile] : drive.tiles) {
      if (tile.content.records.empty()) continue;
      here.emplace_back(tile.touched, &tile);
      records += tile.content.records.size();
    }
    std::sort(here.begin(), here.end());
    for (std::size_t i = 0; i < here.size() && records > most_records; ++i) {
      RecordedTile& tile = *here[i].second;
      records -= tile.content.records.size();
      tile.spilled = dense_map::PackedRecords(std::exchange(tile.content, {}), spill_file_);
    }
    spill_file_.flush_much();
  }

 private:
  SpillFile& spill_file_;
  std::size_t nodes_ = 0;
};

std::optional<RecordedDrive> read_drive(const std::string& path, std::size_t max_bytes, SpillFile* spill_file) {
  RecordedDrive drive;
  std::optional<DriveSpiller> spiller;
  if (spill_file != nullptr) spiller.emplace(*spill_file);
  std::size_t batch = 0, read = 0;
  drive.bytes = read_batches(path, max_bytes, [&](const std::string& items) {
    apply_items(items, drive, ++batch);
    read += items.size();
    if (spiller && read > kSpillInterval) {
      spiller->spill(drive, kMaxRecordsInMemory);
      read = 0;
    }
  });
  if (spiller) spiller->spill(drive, 0);
  if (drive.epoch == 0 || drive.poses.empty()) return std::nullopt;
  check_drive(drive);
  return drive;
}

}  // namespace

std::string make_batch(std::string_view items) {
  BatchHead head;
  head.size = items.size();
  head.checksum = checksum_of(head.size, items);
  std::string batch(reinterpret_cast<const char*>(&head), sizeof head);
  batch += items;
  return batch;
}

/// The last batch of the file may be incomplete.
std::size_t read_batches(const std::string& path, std::size_t max_bytes,
                         const std::function<void(const std::string& items)>& take) {
  std::uintmax_t rest = fs::file_size(path);
  if (rest > max_bytes) throw std::runtime_error(fmt::format("is larger than {} MB", max_bytes / 1'000'000));
  std::ifstream file(path, std::ios::binary);
  std::size_t bytes = 0;
  std::string items;
  BatchHead head;
  while (rest >= sizeof head) {
    if (!file.read(reinterpret_cast<char*>(&head), sizeof head)) throw std::runtime_error("cannot be read");
    rest -= sizeof head;
    if (head.magic != kBatchMagic) throw std::runtime_error("is damaged, or no journal");
    if (head.size > rest) break;
    items.resize(head.size);
    if (!file.read(items.data(), static_cast<std::streamsize>(head.size))) throw std::runtime_error("cannot be read");
    rest -= head.size;
    if (head.checksum != checksum_of(head.size, items)) throw std::runtime_error("is damaged: a checksum is wrong");
    take(items);
    bytes += sizeof head + items.size();
  }
  return bytes;
}

std::optional<double> age_of_journal(const std::string& path) {
  std::error_code error;
  const fs::file_time_type written = fs::last_write_time(path, error);
  if (error) return std::nullopt;
  return std::chrono::duration<double>(fs::file_time_type::clock::now() - written).count();
}

std::optional<RecordedDrive> read_journal(const std::string& path, std::size_t max_bytes,
                                          const std::string& config_hash, SpillFile* spill_file) {
  const std::int64_t failed_before = spill_file != nullptr ? spill_file->failed_reads() : 0;
  try {
    std::optional<RecordedDrive> drive = read_drive(path, max_bytes, spill_file);
    if (drive && drive->config_hash != config_hash) throw std::runtime_error("is of a mapper with other settings");
    return drive;
  } catch (const std::exception& problem) {
    // Then the spill file failed, and the journal is not damaged.
    if (spill_file != nullptr && spill_file->failed_reads() != failed_before)
      return read_journal(path, max_bytes, config_hash);
    throw JournalError(fmt::format("{}: {}", path, problem.what()));
  }
}

}  // namespace curbstone::mapper::journal
