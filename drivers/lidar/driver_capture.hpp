#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/lidar/lidar_config.hpp"
#include "drivers/lidar/models/base/model.hpp"
#include "drivers/lidar/sources/one_sender.hpp"
#include "drivers/lidar/sources/pcap_source.hpp"

namespace curbstone::lidar {

/// The packets of a capture that are meant for the driver: to its two ports, or, where both are 0, of a LiDAR to
/// any port; and of `device_address` where one is set, else of one sender (OneSender).
class DriverCapture {
 public:
  using Packet = sources::PcapSource::Packet;

  /// `repeat`: at its end the file begins anew. Times of receipt and the device's stamps go on by its length and one
  /// mean distance of packets. Throws std::runtime_error, one line: with what the file has instead where no packet is
  /// meant for the driver.
  DriverCapture(const LidarConfig& config, bool repeat);

  /// The packet that comes next; nothing at the end. It is valid until advance().
  [[nodiscard]] const std::optional<Packet>& packet() const { return packet_; }
  /// Throws std::runtime_error where the file is damaged or cut off.
  void advance();

  [[nodiscard]] std::int64_t foreign() const {
    return foreign_ + sender_.foreign();
  }  ///< packets to the ports from other senders
  [[nodiscard]] std::string sender_fault() const { return sender_.fault(newest_); }
  [[nodiscard]] std::int64_t fragments() const { return before_.fragments + source_->skipped().fragments; }
  [[nodiscard]] std::int64_t cut() const { return before_.cut + source_->skipped().cut; }
  [[nodiscard]] std::int64_t repeats() const { return repeats_; }

 private:
  [[nodiscard]] bool any_port() const;
  [[nodiscard]] bool is_for_us(const Packet& packet) const;
  [[nodiscard]] bool is_own(const Packet& packet) const;
  [[nodiscard]] std::optional<Packet> next_in_file();
  void begin_anew();
  void shift_packet();
  [[noreturn]] void fail_empty() const;

  LidarConfig config_;
  bool repeat_;
  std::optional<sources::Ipv4> device_;
  std::unique_ptr<models::Model> model_;  ///< none: auto
  sources::OneSender sender_;
  std::int64_t newest_ = 0;  ///< us, in the file: the packet read last
  std::unique_ptr<sources::PcapSource> source_;
  std::optional<Packet> packet_;
  std::vector<std::uint8_t> shifted_;
  std::int64_t first_ = 0;  ///< us: the file's earliest and latest packet
  std::int64_t last_ = 0;
  std::int64_t count_ = 0;
  std::int64_t shift_ = 0;  ///< us, of the present pass through the file
  std::int64_t repeats_ = 0;
  std::int64_t foreign_ = 0;
  sources::PcapSource::Skipped before_;  ///< in the passes before
};

/// Whether the device says but once, in the whole file, how it is: nothing can confirm it. Reads to the second time.
/// Throws as DriverCapture does.
[[nodiscard]] bool has_one_info(const LidarConfig& config);

}  // namespace curbstone::lidar
