#pragma once

#include <cstdint>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace curbstone::test {

using Bytes = std::vector<std::uint8_t>;

/// "FA FF 30 00 D1"
inline Bytes from_hex(const std::string& text) {
  std::istringstream in(text);
  Bytes bytes;
  for (unsigned value = 0; in >> std::hex >> value;) bytes.push_back(static_cast<std::uint8_t>(value));
  return bytes;
}

inline Bytes from_text(std::string_view text) {
  return Bytes(text.begin(), text.end());
}

/// Empty if there is no such file.
inline Bytes read_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(in), {});
}

inline Bytes random_bytes(std::mt19937& random, std::size_t size) {
  Bytes bytes(size);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

inline void append(Bytes& bytes, const Bytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

}  // namespace curbstone::test
