#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace curbstone::fuzz {

using Seed = std::vector<std::uint8_t>;

/// As Input::number() reads it.
template <std::integral Number>
void put(Seed& seed, Number value) {
  for (std::size_t i = 0; i < sizeof value; ++i) seed.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}
inline void put(Seed& seed, std::span<const std::uint8_t> bytes) {
  seed.insert(seed.end(), bytes.begin(), bytes.end());
}
/// As Input::piece() reads it.
inline void put_piece(Seed& seed, std::span<const std::uint8_t> bytes) {
  put(seed, static_cast<std::uint16_t>(bytes.size()));
  put(seed, bytes);
}

inline std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Where the inputs go that the fuzzer starts from, a folder a target, and where recordings are, if they are.
class SeedFolder {
 public:
  SeedFolder(std::filesystem::path out, std::filesystem::path data) : out_(std::move(out)), data_(std::move(data)) {}

  void write(const std::string& target, const std::string& name, const Seed& seed) const {
    std::filesystem::create_directories(out_ / target);
    std::ofstream file(out_ / target / name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(seed.data()), static_cast<std::streamsize>(seed.size()));
    if (!file.flush()) throw std::runtime_error((out_ / target / name).string() + ": cannot be written");
  }
  /// At most `most` bytes from the beginning of a file; empty where there is none.
  [[nodiscard]] static Seed read(const std::filesystem::path& path, std::size_t most = 1 << 14) {
    std::ifstream file(path, std::ios::binary);
    Seed seed(most);
    file.read(reinterpret_cast<char*>(seed.data()), static_cast<std::streamsize>(most));
    seed.resize(static_cast<std::size_t>(file.gcount()));
    return seed;
  }
  [[nodiscard]] std::filesystem::path recording(const std::string& name) const { return data_ / name; }

 private:
  std::filesystem::path out_;
  std::filesystem::path data_;
};

void write_lidar_seeds(const SeedFolder& folder);
void write_line_seeds(const SeedFolder& folder);
void write_text_seeds(const SeedFolder& folder);
void write_bus_seeds(const SeedFolder& folder);
void write_map_seeds(const SeedFolder& folder);

}  // namespace curbstone::fuzz
