#pragma once

#include <string>

namespace curbstone::bench::faults {

/// A disk of a few hundred MB, in memory, that only this process and its children see. It goes with its owner, and with
/// the process in any case. Throws std::runtime_error where the rights to make it are missing.
class SmallDisk {
 public:
  /// Lies over `folder`, which must exist.
  SmallDisk(std::string folder, int megabytes);
  ~SmallDisk();
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  /// Takes all the room that is left.
  void fill() const;
  /// Gives it back.
  void free() const;

 private:
  [[nodiscard]] std::string ballast() const { return folder_ + "/ballast"; }

  std::string folder_;
};

}  // namespace curbstone::bench::faults
