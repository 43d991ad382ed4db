#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "common/packing/value_packer.hpp"

namespace curbstone {

/// Takes packed values out of a process's memory, into a file that has no name and is gone when the process ends,
/// however it does. A thread of its own writes them: who puts something away does not wait for a disk. What is not yet
/// written is in memory; so is everything without a folder, while the disk is nearly full, and while it cannot be
/// written.
class SpillFile {
 public:
  /// `folder`: of the file; empty: none. One that cannot be written to is a fault, not an error. `leave_free`: bytes of
  /// the disk that are for others.
  explicit SpillFile(const std::string& folder = {}, std::uint64_t leave_free = std::uint64_t{1} << 30);
  /// What was put away may live longer, and the file with it.
  ~SpillFile();
  SpillFile(const SpillFile&) = delete;
  SpillFile& operator=(const SpillFile&) = delete;

  /// Values that were put away. Copies share them; the last one gives their room back. Any thread.
  class Values {
   public:
    /// Nothing has been put away here.
    [[nodiscard]] bool empty() const { return place_ == nullptr; }
    /// Not in memory any more.
    [[nodiscard]] bool is_in_file() const;
    /// As they were; of those that are empty, none. Throws std::runtime_error if the file cannot be read, or holds
    /// something else by now.
    [[nodiscard]] PackedValues read() const;

   private:
    friend class SpillFile;
    struct Place;
    std::shared_ptr<Place> place_;
  };
  [[nodiscard]] Values put(PackedValues values);

  [[nodiscard]] std::size_t bytes_in_memory() const;
  [[nodiscard]] std::size_t bytes_in_file() const;
  /// How often it could not be read, or what was read was not what had been written.
  [[nodiscard]] std::int64_t failed_reads() const;
  /// Why, the last time; empty: it never was so.
  [[nodiscard]] std::string read_fault() const;
  /// Why values stay in memory though there is a folder; empty: they do not.
  [[nodiscard]] std::string fault() const;
  /// Whether what is put away leaves the memory, soon if it has not yet.
  [[nodiscard]] bool takes() const;
  /// Waits until nothing is left to be written, or cannot be for now.
  void flush();
  /// Likewise, if much waits: for who puts a lot away at once and must not fill the memory with it.
  void flush_much();

 private:
  class File;
  std::shared_ptr<File> file_;
  std::thread writer_;
};

}  // namespace curbstone
