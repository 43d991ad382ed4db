#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace curbstone::mapper::journal {

/// Writes a journal's file, each batch in a thread of its own, so that no caller waits for the disk. Nothing is synced:
/// a killed process loses nothing of what was written. A journal with a gap is useless, so if a batch cannot be written
/// the file is deleted, and that is a fault. Calls come from one thread.
class JournalWriter {
 public:
  JournalWriter(std::string path, std::size_t max_bytes) : path_(std::move(path)), max_bytes_(max_bytes) {}
  /// Waits for the current batch; the file stays.
  ~JournalWriter();
  JournalWriter(const JournalWriter&) = delete;
  JournalWriter& operator=(const JournalWriter&) = delete;

  /// Whether the other thread is writing. None of the calls below is allowed then.
  [[nodiscard]] bool busy();
  /// Busy for more than a minute.
  [[nodiscard]] bool is_stuck() const;
  /// The file that is there counts as one of this writer.
  void adopt() { was_in_place_ = true; }
  /// Updates the age of the file in place, which shows that its drive continues.
  void keep_young();
  /// Starts another file with the next batch, beside the current one.
  void begin();
  /// Continues the file in place after its first `bytes` with the next batch: what follows them was cut short.
  void continue_at(std::size_t bytes);
  /// `is_complete`: with this batch the new file is complete enough for a successor, and replaces the previous one.
  void append(std::string batch, bool is_complete);
  /// Deletes the journal: the drive is over. Waits.
  void remove();

  /// Size of the file.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// Empty if there is no fault. After a fault nothing is written until the next begin().
  [[nodiscard]] const std::string& fault() const { return fault_; }
  /// The system's error behind the fault; none if the journal is full.
  [[nodiscard]] std::error_code error() const { return error_; }
  /// Whether the fault is that the journal would exceed its limit: a new one of the same map would as well.
  [[nodiscard]] bool is_full() const { return is_full_; }
  /// Whether the fault is that the disk was full, and there is now room for as much as the file had; or that the file
  /// was deleted.
  [[nodiscard]] bool has_room_again() const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { (void)std::fclose(file); }
  };
  [[nodiscard]] std::error_code put(std::string_view batch, bool takes_place);
  void open(std::optional<std::size_t> after);
  [[nodiscard]] bool is_there() const;
  void keep_alive() const;
  void discard();
  [[nodiscard]] std::string unfinished() const { return path_ + ".unfinished"; }

  std::string path_;
  std::size_t max_bytes_;
  std::unique_ptr<std::FILE, Close> file_;  // owned by the other thread while busy
  bool has_taken_place_ = false;            // the file was renamed to `path`; likewise
  std::future<std::error_code> under_way_;  // result of the write
  std::int64_t began_ = 0;                  // ns, steady clock
  bool is_open_ = false;
  std::optional<std::size_t> after_;  // bytes of the file in place, which the next batch continues; none: a new file
  bool was_in_place_ = false;         // as a file of this writer, or adopted
  bool is_in_place_ = false;
  std::size_t bytes_ = 0;
  std::string fault_;
  std::error_code error_;
  bool is_full_ = false;
};

}  // namespace curbstone::mapper::journal
