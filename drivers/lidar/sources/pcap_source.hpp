#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "drivers/lidar/sources/udp_frame.hpp"

namespace curbstone::lidar::sources {

/// Reads the UDP packets of a capture (.pcap with stamps in us or ns, .pcapng; Ethernet with or without VLAN tags, raw
/// IP, loopback, Linux cooked 1 and 2), of either byte order. The interfaces of a .pcapng may differ in their link
/// type.
class PcapSource {
 public:
  struct Packet {
    std::int64_t received = 0;            ///< us since the Unix epoch, time of capture
    Ipv4 sender = 0;                      ///< source address
    int port = 0;                         ///< destination
    std::span<const std::uint8_t> bytes;  ///< UDP payload; valid until the next call
  };

  /// Frames that were skipped, by cause.
  struct Skipped {
    std::int64_t not_udp = 0;     ///< another protocol
    std::int64_t fragments = 0;   ///< parts of IP packets
    std::int64_t cut = 0;         ///< shorter than their stated length
    std::int64_t other_link = 0;  ///< of an interface whose link type is not supported
    [[nodiscard]] std::int64_t all() const { return not_udp + fragments + cut + other_link; }
    bool operator==(const Skipped&) const = default;
  };

  /// Throws std::runtime_error with a one-line message: what is wrong with the file.
  explicit PcapSource(std::string file);
  ~PcapSource();
  PcapSource(const PcapSource&) = delete;
  PcapSource& operator=(const PcapSource&) = delete;

  /// The next packet; nothing at the end. Frames without a complete UDP packet are skipped. Throws std::runtime_error
  /// if the file is damaged or cut off.
  std::optional<Packet> next();

  [[nodiscard]] const Skipped& skipped() const { return skipped_; }

 private:
  class Impl;
  void skip(FrameKind kind);

  std::string file_;
  std::unique_ptr<Impl> impl_;
  Skipped skipped_;
};

}  // namespace curbstone::lidar::sources
