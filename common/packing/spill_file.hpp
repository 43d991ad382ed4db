#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "common/packing/value_packer.hpp"

namespace curbstone {

/// Moves packed values out of a process's memory into an unnamed file, which disappears when the process ends, for
/// whatever reason. A separate thread writes the values, so the caller does not wait for the disk. Values stay in
/// memory until they are written. They also stay in memory if there is no folder, while the disk is nearly full, and
/// while it cannot be written. It is tried again every `retry`: a folder may appear later, and a disk that failed may
/// be mounted again. What the old file had is then in the old file.
class SpillFile {
 public:
  /// `folder`: of the file; empty: none. A folder that is not there is a fault, not an error. `leave_free`:
  /// bytes of the disk to leave free for other uses. `retry`: after an error.
  explicit SpillFile(const std::string& folder = {}, std::uint64_t leave_free = std::uint64_t{1} << 30,
                     std::chrono::milliseconds retry = std::chrono::seconds(5));
  /// Stored values may outlive this object; the file then lives as long as they do.
  ~SpillFile();
  SpillFile(const SpillFile&) = delete;
  SpillFile& operator=(const SpillFile&) = delete;

  /// A handle to stored values. Copies share the values; the last copy frees their space. Any thread.
  class Values {
   public:
    /// Whether the handle holds no values.
    [[nodiscard]] bool empty() const { return place_ == nullptr; }
    /// Whether the values are only in the file, no longer in memory.
    [[nodiscard]] bool is_in_file() const;
    /// Returns the stored values; none if the handle is empty. Throws std::runtime_error if the file cannot be read or
    /// its content has changed.
    [[nodiscard]] PackedValues read() const;

   private:
    friend class SpillFile;
    struct Place;
    std::shared_ptr<Place> place_;
  };
  [[nodiscard]] Values put(PackedValues values);

  [[nodiscard]] std::size_t bytes_in_memory() const;
  [[nodiscard]] std::size_t bytes_in_file() const;
  /// How often the file could not be read, or its content differed from what was written.
  [[nodiscard]] std::int64_t failed_reads() const;
  /// Values whose last read failed.
  [[nodiscard]] std::int64_t unreadable() const;
  /// The reason of the last failed read; empty if there are no such values.
  [[nodiscard]] std::string read_fault() const;
  /// Why values stay in memory although there is a folder; empty if they do not.
  [[nodiscard]] std::string fault() const;
  /// Whether stored values leave memory, now or soon.
  [[nodiscard]] bool takes() const;
  /// Waits until nothing is left to write, or nothing can be written for now.
  void flush();
  /// Does so only if much is waiting: for callers that store a lot at once and must not fill the memory with it.
  void flush_much();

 private:
  class File;
  std::shared_ptr<File> file_;
  std::thread writer_;
};

}  // namespace curbstone
