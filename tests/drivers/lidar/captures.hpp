#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "tests/temporary_folder.hpp"

namespace curbstone::lidar {

using Bytes = std::vector<std::uint8_t>;

inline void put(Bytes& bytes, std::initializer_list<int> values) {
  for (const int value : values) bytes.push_back(static_cast<std::uint8_t>(value));
}
inline void put16(Bytes& bytes, std::size_t value) {
  put(bytes, {static_cast<int>(value >> 8), static_cast<int>(value & 0xFF)});
}

/// `payload` in UDP in IPv4, from 192.168.1.`sender` to `port`.
inline Bytes ip_packet(const Bytes& payload, int port, int sender = 200) {
  Bytes bytes;
  put(bytes, {0x45, 0x00});
  put16(bytes, 28 + payload.size());
  put(bytes, {0, 1, 0, 0, 64, 17, 0, 0, 192, 168, 1, sender, 192, 168, 1, 102});
  put16(bytes, 6699);
  put16(bytes, static_cast<std::size_t>(port));
  put16(bytes, 8 + payload.size());
  put16(bytes, 0);
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

inline Bytes operator+(Bytes left, const Bytes& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

/// The same in an Ethernet frame, behind `tags` VLAN tags.
inline Bytes frame(const Bytes& payload, int port, int tags = 0, int sender = 200) {
  Bytes bytes(12, 0xAB);
  for (int i = 0; i < tags; ++i) put(bytes, {0x81, 0x00, 0x00, 0x05});
  put(bytes, {0x08, 0x00});
  return bytes + ip_packet(payload, port, sender);
}

inline constexpr std::uint32_t kEthernet = 1;
inline constexpr std::uint32_t kLoopback = 0;  // LINKTYPE_NULL
inline constexpr std::uint32_t kRawIp = 101;
inline constexpr std::uint32_t kCooked = 113;
inline constexpr std::uint32_t kCooked2 = 276;

/// A capture file of its own that goes with the test. Frame i was captured at 100 s + i * `step` us + 42 us.
class Capture {
 public:
  enum class Format { kMicroseconds, kNanoseconds, kPcapng };

  explicit Capture(const std::vector<Bytes>& frames, std::uint32_t link_type = kEthernet,
                   Format format = Format::kMicroseconds, std::int64_t step = 1'000'000) {
    if (format == Format::kPcapng) {
      words({0x0A0D0D0A, 28, 0x1A2B3C4D, 0x00000001, 0xFFFFFFFF, 0xFFFFFFFF, 28});
      words({1, 20, link_type, 0, 20});  // interface: stamps in us
    } else {
      words({format == Format::kNanoseconds ? 0xA1B23C4D : 0xA1B2C3D4, 0x00040002, 0, 0, 65535, link_type});
    }
    std::int64_t time = 100'000'042;
    for (const Bytes& f : frames) {
      write(f, time, format);
      time += step;
    }
    file_.close();
  }
  void cut(std::uintmax_t bytes) const {
    std::filesystem::resize_file(name_, std::filesystem::file_size(name_) - bytes);
  }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  void write(const Bytes& f, std::int64_t time, Format format) {
    const auto size = static_cast<std::uint32_t>(f.size());
    const std::uint32_t padded = (size + 3) / 4 * 4;
    if (format == Format::kPcapng) {
      words({6, 32 + padded, 0, static_cast<std::uint32_t>(time >> 32), static_cast<std::uint32_t>(time), size, size});
    } else {
      const auto unit = format == Format::kNanoseconds ? 1000U : 1U;
      words({static_cast<std::uint32_t>(time / 1'000'000), static_cast<std::uint32_t>(time % 1'000'000) * unit, size,
             size});
    }
    file_.write(reinterpret_cast<const char*>(f.data()), static_cast<std::streamsize>(size));
    if (format != Format::kPcapng) return;
    file_.write("\0\0\0", static_cast<std::streamsize>(padded - size));
    words({32 + padded});
  }
  void words(std::initializer_list<std::uint32_t> words) {
    for (const std::uint32_t word : words) file_.write(reinterpret_cast<const char*>(&word), sizeof word);
  }
  test::TemporaryFolder folder_;
  std::string name_ = folder_ / "capture.pcap";
  std::ofstream file_{name_, std::ios::binary};
};

}  // namespace curbstone::lidar
