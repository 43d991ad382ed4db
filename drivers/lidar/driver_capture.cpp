#include "drivers/lidar/driver_capture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "drivers/lidar/models/base/sender.hpp"
#include "drivers/lidar/packet_role.hpp"
#include "drivers/lidar/sources/capture_contents.hpp"
#include "drivers/lidar/stamp_shift.hpp"

namespace curbstone::lidar {

DriverCapture::DriverCapture(const LidarConfig& config, bool repeat)
    : config_(config),
      repeat_(repeat),
      model_(models::make_model(config.model, {})),
      source_(std::make_unique<sources::PcapSource>(config.pcap)) {
  if (!config.device_address.empty()) device_ = sources::parse_ipv4(config.device_address, "device_address");
  packet_ = next_in_file();
  if (!packet_) fail_empty();
  first_ = last_ = packet_->received;
}

void DriverCapture::advance() {
  packet_ = next_in_file();
  if (!packet_ && repeat_) restart_file();
  if (!packet_) return;
  if (repeats_ == 0) {
    first_ = std::min(first_, packet_->received);
    last_ = std::max(last_, packet_->received);
  } else {
    shift_packet();
  }
}

bool DriverCapture::any_port() const {
  return config_.msop_port == 0 && config_.difop_port == 0;
}

bool DriverCapture::is_for_us(const Packet& packet) const {
  if (any_port()) return models::sender_of(packet.bytes) != models::Sender::kUnknown;
  return ports_of(config_).contains(packet.port);
}

sources::OneSender::Kind DriverCapture::role_of_packet(const Packet& packet) const {
  return role_of(model_.get(), models::sender_of(packet.bytes));
}

std::optional<DriverCapture::Packet> DriverCapture::next_in_file() {
  while (auto packet = source_->next()) {
    newest_ = packet->received;
    if (!is_for_us(*packet)) continue;
    if (device_ && packet->sender != *device_) {
      ++foreign_;
      continue;
    }
    if (!sender_.admits(packet->sender, packet->received, role_of_packet(*packet))) continue;
    if (repeats_ == 0) ++count_;
    return packet;
  }
  return std::nullopt;
}

void DriverCapture::restart_file() {
  const std::int64_t length = last_ - first_;
  constexpr std::int64_t kMinLength = 1000;  // us, for a file with one packet
  shift_ += std::max(kMinLength, length + (count_ > 1 ? length / (count_ - 1) : 0));
  ++repeats_;
  before_.fragments += source_->skipped().fragments;
  before_.cut += source_->skipped().cut;
  source_ = std::make_unique<sources::PcapSource>(config_.pcap);
  packet_ = next_in_file();
}

void DriverCapture::shift_packet() {
  shifted_.assign(packet_->bytes.begin(), packet_->bytes.end());
  shift_stamp(shifted_, shift_);
  packet_->bytes = shifted_;
  packet_->received += shift_;
}

void DriverCapture::fail_empty() const {
  const std::string from = device_ ? " from " + config_.device_address : "";
  const std::string wanted =
      any_port() ? "of a LiDAR" : fmt::format("to port {} or {}", point_port(config_), info_port(config_));
  throw std::runtime_error(fmt::format("{}: no UDP packet{} {} in it; it has: {}", config_.pcap, from, wanted,
                                       to_text(sources::contents_of(config_.pcap))));
}

bool has_one_info(const LidarConfig& config) {
  int infos = 0;
  try {
    for (DriverCapture capture(config, false); capture.packet() && infos < 2; capture.advance()) {
      const models::Sender sender = models::sender_of(capture.packet()->bytes);
      if (sender == models::Sender::kHeliosInfo || sender == models::Sender::kRs16Info) ++infos;
    }
  } catch (const std::runtime_error&) {
    // The contents of a truncated file are used; its reader reports the error.
  }
  return infos == 1;
}

}  // namespace curbstone::lidar
