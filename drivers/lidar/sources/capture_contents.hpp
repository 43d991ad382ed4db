#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "drivers/lidar/sources/pcap_source.hpp"

namespace curbstone::lidar::sources {

/// Packets in a capture for one port from one sender.
struct PortContents {
  Ipv4 sender = 0;
  int port = 0;
  std::int64_t packets = 0;
  std::map<std::size_t, std::int64_t> by_length;  ///< packets, by bytes of payload
};

struct CaptureContents {
  std::vector<PortContents> ports;  ///< those with the most packets first
  PcapSource::Skipped skipped;
  std::int64_t packets = 0;  ///< of all ports
};

/// Reads the whole file, which may be cut off at its end. Throws std::runtime_error with a one-line message if it
/// cannot be opened.
[[nodiscard]] CaptureContents contents_of(const std::string& file);

/// "; 12 IP fragments; 3 frames cut off; 7 frames that are not UDP over IPv4": those that occur.
[[nodiscard]] std::string to_text(const PcapSource::Skipped& skipped);

/// "port 2368 from 192.168.1.201: 453 packets of 1206 bytes; port 8308 ...": at most `ports` of them, the rest counted.
[[nodiscard]] std::string to_text(const CaptureContents& contents, std::size_t ports = 6);

}  // namespace curbstone::lidar::sources
