#pragma once

#include <string>

namespace curbstone::bench::faults {

/// A RAM disk of a few hundred MB that only this process and its children see. It is removed with this object, and at
/// the latest with the process. Throws std::runtime_error without the rights to make it.
class SmallDisk {
 public:
  /// Mounts over `folder`, which must exist.
  SmallDisk(std::string folder, int megabytes);
  ~SmallDisk();
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  /// Fills all free space.
  void fill() const;
  /// Frees the space again.
  void free() const;

 private:
  [[nodiscard]] std::string ballast() const { return folder_ + "/ballast"; }

  std::string folder_;
};

}  // namespace curbstone::bench::faults
