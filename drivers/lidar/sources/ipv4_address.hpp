#pragma once

#include <cstdint>
#include <string>

namespace curbstone::lidar::sources {

/// An IPv4 address as a number: 192.168.1.200 is 0xC0A801C8.
using Ipv4 = std::uint32_t;

/// Throws std::invalid_argument that names `key` if the text is not an address.
[[nodiscard]] Ipv4 parse_ipv4(const std::string& text, const char* key);

[[nodiscard]] std::string to_text(Ipv4 address);

}  // namespace curbstone::lidar::sources
