#include "services/mapper/journal/local_map_journal.hpp"

#include <algorithm>

#include "common/time/has_passed.hpp"
#include "services/mapper/journal/journal_file.hpp"
#include "services/mapper/journal/local_map_file.hpp"

namespace curbstone::mapper::journal {
namespace {

constexpr std::int64_t kInterval = 500'000;      // us between two times at which the file is complete
constexpr std::int64_t kRetryMap = 5'000'000;    // us after a failure
constexpr std::size_t kVoxels = 8192;            // of a level, copied at a time: a millisecond
constexpr std::size_t kLeastGrowth = 4'000'000;  // bytes

}  // namespace

bool LocalMapJournal::is_too_large() const {
  return whole_bytes_ != 0 && writer_.bytes() > whole_bytes_ + std::max(whole_bytes_ / 2, kLeastGrowth);
}

void LocalMapJournal::begin(std::span<registration::ShapeLevel* const> levels) {
  for (registration::ShapeLevel* level : levels) level->note_changes();
  writer_.begin();
  whole_bytes_ = 0;
  failed_ = 0;
}

void LocalMapJournal::write(std::span<registration::ShapeLevel* const> levels, std::int32_t epoch, std::int64_t utime,
                            std::int64_t now) {
  if (writer_.busy()) return;
  if (!writer_.fault().empty()) {
    if (failed_ == 0) failed_ = now;
    if (!has_passed(kRetryMap, failed_, now)) return;
  }
  const bool is_another =
      std::any_of(levels.begin(), levels.end(), [](auto* level) { return !level->notes_changes(); });
  if (!is_another && !is_begun_ && adopted_bytes_ != 0) {
    writer_.continue_at(adopted_bytes_);
    whole_bytes_ = adopted_bytes_;
  } else if (is_another || !is_begun_ || failed_ != 0 || is_too_large()) {
    begin(levels);
  } else if (!is_draining_ && epoch == epoch_ && !has_passed(kInterval, written_, now)) {
    return;
  }
  is_begun_ = true;
  epoch_ = epoch;
  LocalMapPart part{config_hash_, epoch, 0, {}};
  is_draining_ = false;
  for (registration::ShapeLevel* level : levels) {
    part.levels.push_back(level->take_changed(kVoxels));
    is_draining_ = is_draining_ || level->num_changed() > 0;
  }
  if (!is_draining_) part.utime = utime;
  writer_.append(make_batch(encoded(part)), !is_draining_);
  if (is_draining_) return;
  written_ = now;
  if (whole_bytes_ == 0) whole_bytes_ = writer_.bytes();
}

}  // namespace curbstone::mapper::journal
