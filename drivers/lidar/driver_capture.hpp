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

/// The packets of a capture that the driver would receive: to its two ports or, if both are 0, of a LiDAR to any port;
/// and from `device_address` if it is set, else from one sender (OneSender).
class DriverCapture {
 public:
  using Packet = sources::PcapSource::Packet;

  /// `repeat`: at its end the file restarts. Times of receipt and the device's stamps continue, shifted by its length
  /// plus one mean interval of packets. Throws std::runtime_error with a one-line message, which lists the file's
  /// contents if no packet is for the driver.
  DriverCapture(const LidarConfig& config, bool repeat);

  /// The next packet; nothing at the end. It is valid until advance().
  [[nodiscard]] const std::optional<Packet>& packet() const { return packet_; }
  /// Whether it is of another device than those before: once.
  [[nodiscard]] bool is_another() { return sender_.is_another(); }
  /// Throws std::runtime_error if the file is damaged or cut off.
  void advance();

  [[nodiscard]] std::int64_t foreign() const { return foreign_ + sender_.foreign(); }  ///< from other senders
  [[nodiscard]] std::string sender_fault() const { return sender_.fault(newest_); }
  [[nodiscard]] std::int64_t fragments() const { return before_.fragments + source_->skipped().fragments; }
  [[nodiscard]] std::int64_t cut() const { return before_.cut + source_->skipped().cut; }
  [[nodiscard]] std::int64_t repeats() const { return repeats_; }

 private:
  [[nodiscard]] bool any_port() const;
  [[nodiscard]] bool is_for_us(const Packet& packet) const;
  [[nodiscard]] sources::OneSender::Kind role_of_packet(const Packet& packet) const;
  [[nodiscard]] std::optional<Packet> next_in_file();
  void restart_file();
  void shift_packet();
  [[noreturn]] void fail_empty() const;

  LidarConfig config_;
  bool repeat_;
  std::optional<sources::Ipv4> device_;
  std::unique_ptr<models::Model> model_;  ///< none: auto
  sources::OneSender sender_;
  std::int64_t newest_ = 0;  ///< us, time in the file of the latest packet
  std::unique_ptr<sources::PcapSource> source_;
  std::optional<Packet> packet_;
  std::vector<std::uint8_t> shifted_;
  std::int64_t first_ = 0;  ///< us: the file's earliest and latest packet
  std::int64_t last_ = 0;
  std::int64_t count_ = 0;
  std::int64_t shift_ = 0;  ///< us, of the current pass through the file
  std::int64_t repeats_ = 0;
  std::int64_t foreign_ = 0;
  sources::PcapSource::Skipped before_;  ///< in earlier passes
};

/// Whether the file contains only one device information, so that no second one can confirm it. Reads up to the second
/// one. Throws as DriverCapture does.
[[nodiscard]] bool has_one_info(const LidarConfig& config);

}  // namespace curbstone::lidar
