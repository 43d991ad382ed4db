#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace curbstone::procman::golden {

/// @file
/// A message of each of procman's types, as its bytes are on the wire, in hex. Written down from procman's definitions
/// (github.com/ashuang/procman, `lcmtypes/`) and LCM's encoding, not by our encoder: fingerprint of the type, then the
/// fields in order, big-endian; a string is its length with the NUL, its bytes, the NUL; a struct within a struct has
/// no fingerprint.

inline constexpr std::int64_t kUtime = 1'700'000'000'123'456;  // us

inline constexpr std::string_view kCmd =
    "2277f449a855d330"            // fingerprint
    "000000076d617070657200"      // "mapper"
    "00000009736c65657020363000"  // "sleep 60"
    "000000046d617000"            // "map"
    "01"                          // auto_respawn true
    "0f"                          // stop_signal 15
    "40200000";                   // stop_time_allowed 2.5

inline constexpr std::string_view kDesired =
    "b2a6c7a09ba54539"            // fingerprint
    "000000076d617070657200"      // "mapper"
    "00000009736c65657020363000"  // "sleep 60"
    "000000046d617000"            // "map"
    "01"                          // auto_respawn true
    "0f"                          // stop_signal 15
    "40200000"                    // stop_time_allowed 2.5
    "00000003"                    // desired_runid 3
    "01";                         // force_quit true

inline constexpr std::string_view kStatus =
    "a8e0208786cf86e3"            // fingerprint
    "000000076d617070657200"      // "mapper"
    "00000009736c65657020363000"  // "sleep 60"
    "000000046d617000"            // "map"
    "01"                          // auto_respawn true
    "0f"                          // stop_signal 15
    "40200000"                    // stop_time_allowed 2.5
    "00001267"                    // pid 4711
    "00000003"                    // actual_runid 3
    "00000000"                    // exit_code 0
    "3e800000"                    // cpu_usage 0.25
    "0000000100000000"            // mem_vsize_bytes 2^32
    "0000000000bc614e";           // mem_rss_bytes 12345678

inline constexpr std::string_view kInfo =
    "8876aeb040efd01f"            // fingerprint
    "00060a2418202240"            // utime 1700000000123456
    "0000000475677600"            // "ugv"
    "3f000000"                    // cpu_load 0.5
    "0000000200000000"            // phys_mem_total_bytes 8 GiB
    "00000000c0000000"            // phys_mem_free_bytes 3 GiB
    "ffffffffffffffff"            // swap_total_bytes -1
    "0000000000000000"            // swap_free_bytes 0
    "00000002"                    // ncmds 2
    "00000004656b6600"            // "ekf"
    "000000057472756500"          // "true"
    "0000000100"                  // an empty string: its NUL alone
    "00"                          // auto_respawn false
    "02"                          // stop_signal 2
    "40e00000"                    // stop_time_allowed 7.0
    "00000000"                    // pid 0: not running
    "00000001"                    // actual_runid 1
    "00000300"                    // exit_code 0x300: exit(3)
    "00000000"                    // cpu_usage 0
    "0000000000000000"            // mem_vsize_bytes
    "0000000000000000"            // mem_rss_bytes
    "000000076d617070657200"      // "mapper"
    "00000009736c65657020363000"  // "sleep 60"
    "000000046d617000"            // "map"
    "01"                          // auto_respawn true
    "0f"                          // stop_signal 15
    "40200000"                    // stop_time_allowed 2.5
    "00001267"                    // pid 4711
    "00000003"                    // actual_runid 3
    "00000000"                    // exit_code 0
    "3e800000"                    // cpu_usage 0.25
    "0000000100000000"            // mem_vsize_bytes 2^32
    "0000000000bc614e";           // mem_rss_bytes 12345678

inline constexpr std::string_view kOrders =
    "d343f45b171ab855"                // fingerprint
    "00060a2418202240"                // utime 1700000000123456
    "0000000475677600"                // "ugv"
    "0000000b686f73743a31323a333400"  // "host:12:34"
    "00000002"                        // ncmds 2
    "00000004656b6600"                // "ekf"
    "000000057472756500"              // "true"
    "0000000100"                      // an empty string: its NUL alone
    "00"                              // auto_respawn false
    "02"                              // stop_signal 2
    "40e00000"                        // stop_time_allowed 7.0
    "00000002"                        // desired_runid 2: one more than it has had
    "00"                              // force_quit false
    "000000076d617070657200"          // "mapper"
    "00000009736c65657020363000"      // "sleep 60"
    "000000046d617000"                // "map"
    "01"                              // auto_respawn true
    "0f"                              // stop_signal 15
    "40200000"                        // stop_time_allowed 2.5
    "00000003"                        // desired_runid 3: as it is
    "00";                             // force_quit false

inline constexpr std::string_view kOutput =
    "8efa5caf5da01eb3"           // fingerprint
    "00060a2418202240"           // utime 1700000000123456
    "0000000475677600"           // "ugv"
    "0002"                       // num_commands 2, an int16
    "000000076d617070657200"     // "mapper"
    "0000000100"                 // an empty string: its NUL alone
    "0000000872656164790d0a00"   // "ready\r\n"
    "000000084b696c6c65640a00";  // "Killed\n"

inline constexpr std::string_view kDiscovery =
    "b1c83182bed74b95"   // fingerprint
    "00060a2418202240"   // utime 1700000000123456
    "0000000475677600"   // "ugv"
    "0000000000001267";  // nonce 4711: the deputy's pid

[[nodiscard]] inline std::vector<std::uint8_t> bytes_of(std::string_view hex) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16)));
  return bytes;
}

[[nodiscard]] inline std::string hex_of(const std::vector<std::uint8_t>& bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string hex;
  for (const std::uint8_t byte : bytes) {
    hex += kDigits[byte >> 4];
    hex += kDigits[byte & 15];
  }
  return hex;
}

}  // namespace curbstone::procman::golden
