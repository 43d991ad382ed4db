#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>

namespace curbstone::test {

/// A folder of its owner's own, whatever other tests run at the same time. It goes with its owner, unless the test
/// failed: then it stays to be looked at, and its name is printed.
class TemporaryFolder {
 public:
  TemporaryFolder() : TemporaryFolder(::testing::TempDir()) {}
  /// In memory, where there is such a place: for tests that write thousands of files, which takes a disk a minute.
  [[nodiscard]] static TemporaryFolder in_memory() {
    const char* memory = "/dev/shm";
    return std::filesystem::is_directory(memory) ? TemporaryFolder(memory) : TemporaryFolder();
  }
  ~TemporaryFolder() {
    if (::testing::Test::HasFailure()) {
      std::cout << "what the test left is in " << path_.string() << std::endl;
      return;
    }
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }

 private:
  explicit TemporaryFolder(const std::filesystem::path& parent) {
    std::string pattern = (parent / "curbstone_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("mkdtemp " + pattern);
    path_ = pattern;
  }

  std::filesystem::path path_;
};

}  // namespace curbstone::test
