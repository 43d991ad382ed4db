#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace curbstone::semantic_map::store {

/// The files beside the map into which earlier drives were moved, and which of them is to be removed. There are at most
/// two: one that is `kept`, as the mapper began a new map in mid-drive; and one that is `superseded`, as the mapper has
/// sent the same drive once more, corrected.
///
/// | event | kept | superseded |
/// |---|---|---|
/// | move_aside(), move_aside_of_predecessor() | the new file | unchanged |
/// | correct(), the same drive as `kept` | none | what was `kept`; the former ones are removed from the disk |
/// | correct(), another drive | unchanged | unchanged |
/// | adopt(), after a restart | unchanged | the given one, if there was none |
/// | remove_superseded() | unchanged | none; removed from the disk |
///
/// One thread.
class EarlierDrive {
 public:
  /// The stored drive goes to `file`, as another began at `utime`, us. `first_utime`: us, of its first pose.
  void move_aside(std::string file, std::int64_t first_utime, std::int64_t utime) {
    kept_ = Kept{std::move(file), {}, first_utime, utime};
  }
  /// The same at the first pose after a restart of the service: the drive is an earlier one, or that of a mapper which
  /// was killed as well, and whose successor sends it again. `superseded`: the file that its map was going to replace.
  void move_aside_of_predecessor(std::string file, std::int64_t first_utime, std::string superseded) {
    kept_ = Kept{std::move(file), std::move(superseded), first_utime, std::nullopt};
  }
  /// The mapper has corrected the whole drive from `first_utime`, us, on. True if `kept` was the same drive: it is
  /// superseded now.
  bool correct(std::int64_t first_utime);
  /// The file that a predecessor, which died, was going to remove; empty: none.
  void adopt(const std::string& superseded) {
    if (superseded_.empty()) superseded_ = superseded;
  }
  /// Removes the superseded file; if that fails, it stays on the disk.
  void remove_superseded();

  /// Empty if there is none.
  [[nodiscard]] const std::string& superseded() const { return superseded_; }
  /// The fault that a new map began in mid-drive, once no correction has come for some seconds: `utime`, us, is that of
  /// the newest pose. Empty: none.
  [[nodiscard]] std::string fault(std::int64_t utime) const;

 private:
  struct Kept {
    std::string file;
    std::string superseded;             // what its map was going to replace; empty: nothing
    std::int64_t first_utime;           // us
    std::optional<std::int64_t> moved;  // us, when it was moved aside in mid-drive
  };
  std::optional<Kept> kept_;
  std::string superseded_;
};

}  // namespace curbstone::semantic_map::store
