#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <future>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>

namespace curbstone::mapper::journal {

/// Writes a journal's file, each batch in a thread of its own: nobody waits for the disk. Nothing is forced to the disk
/// either: a process that is killed loses nothing of what was written. A journal with a hole is none, so where a batch
/// cannot be written the file goes, and that is a fault. One thread calls.
class JournalWriter {
 public:
  JournalWriter(std::string path, std::size_t max_bytes) : path_(std::move(path)), max_bytes_(max_bytes) {}
  /// Waits for what is under way; the file stays.
  ~JournalWriter();
  JournalWriter(const JournalWriter&) = delete;
  JournalWriter& operator=(const JournalWriter&) = delete;

  /// Whether the disk is being waited for, in the other thread. None of the calls below is allowed then.
  [[nodiscard]] bool busy();
  /// Busy, and for more than a minute.
  [[nodiscard]] bool is_stuck() const;
  /// The next batch begins another file, beside the one there is.
  void begin();
  /// `is_whole`: with this batch the file is of use to a successor, and takes the place of the one before.
  void append(std::string batch, bool is_whole);
  /// The drive is over: there is no journal any more. Waits.
  void remove();

  /// Of the file.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// Nothing is written until the next begin(). Empty when all is well.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  /// Of the system, that the fault is of; none where the journal is full.
  [[nodiscard]] std::error_code error() const { return error_; }
  /// The fault is that the journal would be larger than allowed: the same map's will be again.
  [[nodiscard]] bool is_full() const { return is_full_; }
  /// The fault is that the disk was full, and now there is room for as much as the file had.
  [[nodiscard]] bool has_room_again() const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { (void)std::fclose(file); }
  };
  [[nodiscard]] std::error_code put(std::string_view batch, bool opens, bool takes_place);
  void keep_alive() const;
  void discard();
  [[nodiscard]] std::string unfinished() const { return path_ + ".unfinished"; }

  std::string path_;
  std::size_t max_bytes_;
  std::unique_ptr<std::FILE, Close> file_;  // the other thread's, while busy
  std::future<std::error_code> under_way_;  // what went wrong
  std::int64_t began_ = 0;                  // ns, steady clock
  bool is_open_ = false;
  bool was_in_place_ = false;  // a file of this writer
  bool is_in_place_ = false;
  std::size_t bytes_ = 0;
  std::string fault_;
  std::error_code error_;
  bool is_full_ = false;
};

}  // namespace curbstone::mapper::journal
