#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "common/packing/spill_file.hpp"
#include "services/mapper/journal/recorded_drive.hpp"

namespace curbstone::mapper::journal {

/// A journal is one file: batches of items (journal_codec.hpp), each with its size and checksum, appended as the drive
/// goes on. Who dies while he writes leaves a batch that is not whole at the end: it is left out.

/// A batch as it stands in the file.
[[nodiscard]] std::string make_batch(std::string_view items);

/// How long ago the journal was written to, s, by the host's clock: below zero where that was set back. Nothing if
/// there is none.
[[nodiscard]] std::optional<double> age_of_journal(const std::string& path);

/// The drive that somebody with the same `config_hash` was killed in. Nothing if it holds nothing yet. Throws
/// JournalError: of a mapper with other settings, larger than `max_bytes`, damaged, or cannot be read. `far`: where
/// most of it is put away as it is read, so that the whole of it is never in memory; null: it is.
[[nodiscard]] std::optional<RecordedDrive> read_journal(const std::string& path, std::size_t max_bytes,
                                                        const std::string& config_hash, SpillFile* far = nullptr);

}  // namespace curbstone::mapper::journal
