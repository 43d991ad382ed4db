#include "common/file_kind/file_kind.hpp"

#include <algorithm>
#include <array>
#include <fstream>

#include "common/bytes/big_endian.hpp"

namespace curbstone {

namespace {

using std::string_view_literals::operator""sv;

struct Kind {
  std::string_view magic;
  std::string_view text;
  std::size_t at = 0;  ///< bytes from the file's beginning
};

constexpr std::string_view kCapture =
    "a capture of packets: 'curbstone lidar info' says what is in it, 'curbstone-lidar --set pcap=FILE' plays it";
constexpr std::string_view kCloud = "a point cloud: 'curbstone detect' reads it";

constexpr std::array kKinds = {
    Kind{"\xED\xA1\xDA\x01"sv, "an LCM log: 'curbstone replay' makes a map of it"},
    Kind{"\x1F\x8B"sv, "a file compressed by gzip: unpack it first (gunzip)"},
    Kind{"\x28\xB5\x2F\xFD"sv, "a file compressed by zstd: unpack it first (unzstd)"},
    Kind{"\xFD"
         "7zXZ\0"sv,
         "a file compressed by xz: unpack it first (unxz)"},
    Kind{"BZh"sv, "a file compressed by bzip2: unpack it first (bunzip2)"},
    Kind{"\x04\x22\x4D\x18"sv, "a file compressed by lz4: unpack it first (unlz4)"},
    Kind{"PK\x03\x04"sv, "a ZIP archive: unpack it first (unzip)"},
    Kind{"ustar"sv, "a tar archive: unpack it first (tar xf)", 257},
    Kind{"#ROSBAG V"sv, "a bag of ROS 1, which is not read: 'curbstone detect' reads clouds that are saved as .pcd"},
    Kind{"\x89MCAP0\r\n"sv, "an MCAP file, which is written only: give the LCM log of the drive"},
    Kind{"\xD4\xC3\xB2\xA1"sv, kCapture},
    Kind{"\xA1\xB2\xC3\xD4"sv, kCapture},
    Kind{"\x4D\x3C\xB2\xA1"sv, kCapture},  // stamps in nanoseconds
    Kind{"\xA1\xB2\x3C\x4D"sv, kCapture},
    Kind{"\x0A\x0D\x0D\x0A"sv, kCapture},  // pcapng
    Kind{"# .PCD v"sv, kCloud},
    Kind{"ply\n"sv, kCloud},
    Kind{"ply\r\n"sv, kCloud},
};

constexpr std::string_view kSqlite = "SQLite format 3\0"sv;
constexpr std::size_t kApplicationAt = 68;             // in the header of an SQLite file
constexpr std::uint32_t kMapApplication = 0x43555242;  // "CURB": services/semantic_map/store

}  // namespace

std::string_view file_kind(std::span<const std::uint8_t> head) {
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  if (text.starts_with(kSqlite)) {
    const bool is_map = head.size() >= kApplicationAt + 4 &&
                        read_big_endian<std::uint32_t>(head.subspan(kApplicationAt)) == kMapApplication;
    return is_map ? "a map: 'curbstone view', 'export' and 'localise' read it"
                  : "an SQLite file, such as a bag of ROS 2, which is not read";
  }
  const auto kind = std::find_if(kKinds.begin(), kKinds.end(), [&](const Kind& k) {
    return text.size() >= k.at && text.substr(k.at).starts_with(k.magic);
  });
  return kind == kKinds.end() ? ""sv : kind->text;
}

std::string_view file_kind(const std::string& file) {
  std::array<char, kFileKindBytes> head{};
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), head.size());
  return file_kind(
      std::span(reinterpret_cast<const std::uint8_t*>(head.data()), static_cast<std::size_t>(in.gcount())));
}

}  // namespace curbstone
