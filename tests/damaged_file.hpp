#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>

namespace curbstone::test {

/// Writes nonsense over the middle of a file. What falls within a message is no damage that a log shows: write more
/// bytes than a message has.
inline void damage_middle(const std::string& file, std::size_t bytes) {
  const auto middle = static_cast<std::streamoff>(std::filesystem::file_size(file) / 2);
  std::fstream out(file, std::ios::in | std::ios::out | std::ios::binary);
  out.seekp(middle);
  out << std::string(bytes, 'x');
}

}  // namespace curbstone::test
