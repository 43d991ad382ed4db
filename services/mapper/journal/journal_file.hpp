#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "common/packing/spill_file.hpp"
#include "services/mapper/journal/recorded_drive.hpp"

namespace curbstone::mapper::journal {

/// A journal is one file: batches of items (journal_codec.hpp), each with its size and checksum, appended as the drive
/// goes on. A writer that dies may leave an incomplete batch at the end: it is ignored.

/// A batch as it is stored in the file.
[[nodiscard]] std::string make_batch(std::string_view items);

/// Reads a file of batches, and calls `take` for the items of each one that is whole. Returns the bytes of these.
/// Throws std::runtime_error if the file is larger than `max_bytes`, is damaged, or cannot be read, and what `take`
/// throws.
std::size_t read_batches(const std::string& path, std::size_t max_bytes,
                         const std::function<void(const std::string& items)>& take);

/// Time since the journal was last written, s, by the host's clock: negative if the clock was set back. Nothing if
/// there is no journal.
[[nodiscard]] std::optional<double> age_of_journal(const std::string& path);

/// Reads the drive of a mapper with the same `config_hash` that was killed. Nothing if the journal has no drive yet.
/// Throws JournalError if the journal is of a mapper with other settings, is larger than `max_bytes`, is damaged, or
/// cannot be read. `spill_file`: file to which most of the drive is spilled while it is read, so that it is never in
/// memory as a whole; null: all of it is in memory.
[[nodiscard]] std::optional<RecordedDrive> read_journal(const std::string& path, std::size_t max_bytes,
                                                        const std::string& config_hash,
                                                        SpillFile* spill_file = nullptr);

}  // namespace curbstone::mapper::journal
