#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace curbstone::lidar::sources {

/// The UDP packets of a capture (.pcap or .pcapng; Ethernet with or without VLAN tags, raw IP, Linux cooked).
class PcapSource {
 public:
  struct Packet {
    std::int64_t received = 0;            ///< us since the Unix epoch, when it was captured
    int port = 0;                         ///< destination
    std::span<const std::uint8_t> bytes;  ///< UDP payload; valid until the next call
  };

  /// Throws std::runtime_error with one line: what is wrong with the file.
  explicit PcapSource(std::string file);
  ~PcapSource();
  PcapSource(const PcapSource&) = delete;
  PcapSource& operator=(const PcapSource&) = delete;

  /// The next packet; nothing at the end. Frames that hold no whole UDP packet are skipped. Throws std::runtime_error
  /// where the file is damaged or cut off.
  std::optional<Packet> next();

  [[nodiscard]] std::int64_t skipped() const { return skipped_; }  ///< frames that were not whole UDP packets

 private:
  class Impl;
  std::string file_;
  std::unique_ptr<Impl> impl_;
  std::int64_t skipped_ = 0;
};

}  // namespace curbstone::lidar::sources
