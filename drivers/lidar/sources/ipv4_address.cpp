#include "drivers/lidar/sources/ipv4_address.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <stdexcept>

namespace curbstone::lidar::sources {

Ipv4 parse_ipv4(const std::string& text, const char* key) {
  in_addr address{};
  if (inet_pton(AF_INET, text.c_str(), &address) != 1)
    throw std::invalid_argument(fmt::format("{}: '{}' is no IPv4 address", key, text));
  return ntohl(address.s_addr);
}

std::string to_text(Ipv4 address) {
  return fmt::format("{}.{}.{}.{}", address >> 24, address >> 16 & 0xFF, address >> 8 & 0xFF, address & 0xFF);
}

}  // namespace curbstone::lidar::sources
