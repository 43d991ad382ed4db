#include "tools/lidar_tool/sensor.hpp"

#include <algorithm>

namespace curbstone::lidar_tool {

using lidar::models::PacketKind;
using lidar::models::Sender;

namespace {

lidar::LidarConfig config_of(lidar::models::ModelName model) {
  lidar::LidarConfig config;
  config.model = model;
  return config;
}

/// Empty if the packet does not state the mode.
std::string mode_in(Sender kind, std::span<const std::uint8_t> bytes) {
  if (kind == Sender::kVlp16) {
    const int mode = bytes[1204];
    return mode == 0x37 ? "strongest" : mode == 0x38 ? "last" : mode == 0x39 ? "dual" : "";
  }
  if (kind == Sender::kRs16Info) {
    const int mode = bytes[300];
    return mode == 0 ? "dual" : mode == 1 ? "strongest" : mode == 2 ? "last" : "";
  }
  if (kind == Sender::kHeliosInfo) {
    const int mode = bytes[300];
    return mode == 0 ? "dual" : mode == 4 ? "strongest" : mode == 5 ? "last" : mode == 6 ? "first" : "";
  }
  return "";
}

}  // namespace

Sensor::Sensor(lidar::models::ModelName model, const OnPoints& on_points)
    : node_(config_of(model), bus_, [] { return true; }),
      model_(lidar::models::make_model(model, {.limits = {}, .distance_step = {}, .angles = {}})) {
  if (on_points) bus_.subscribe<lidar_points_t>("LIDAR_POINTS", on_points);
}

void Sensor::prepare(const Packet& packet) {
  const Sender kind = lidar::models::sender_of(packet.bytes);
  if (model_->kind_of(kind) != PacketKind::kInfo) return;
  take_info(packet.received, packet.port, packet.bytes);
  only_info_.reset();
  if (++prepared_ == 1) only_info_ = Info{packet.received, packet.port, {packet.bytes.begin(), packet.bytes.end()}};
}

/// A driver accepts device information once two packets agree, so that a damaged one sets nothing. A short capture may
/// have only one: that one is sent twice.
void Sensor::finish_preparing() {
  if (only_info_) take_info(only_info_->received, only_info_->port, only_info_->bytes);
  only_info_.reset();
}

void Sensor::take_info(std::int64_t received, int port, std::span<const std::uint8_t> bytes) {
  node_.on_packet(received, port, bytes);
  (void)model_->read_info(received, bytes);
}

void Sensor::on_packet(const Packet& packet) {
  const Sender kind = lidar::models::sender_of(packet.bytes);
  if (const std::string mode = mode_in(kind, packet.bytes); !mode.empty()) return_mode_ = mode;
  const PacketKind is = model_->kind_of(kind);
  if (is == PacketKind::kInfo) (void)model_->read_info(packet.received, packet.bytes);
  if (is == PacketKind::kPoints &&
      model_->decode(packet.received, packet.bytes, decoded_) == lidar::decoding::Refusal::kNone) {
    const double rpm = decoded_.rate / 36000.0 * 60.0;
    rpm_ = rpm_ == 0 ? rpm : rpm_ + 0.02 * (rpm - rpm_);
    if (decoded_.stamp) {
      const std::int64_t difference = *decoded_.stamp - packet.received;
      clock_difference_ = std::max(clock_difference_.value_or(difference), difference);
      last_stamp_ = decoded_.stamp;
    }
  }
  node_.on_packet(packet.received, packet.port, packet.bytes);
  bus_.dispatch();
}

void Sensor::finish() {
  node_.finish();
  bus_.dispatch();
}

std::int64_t Sensor::refused() const {
  std::int64_t sum = 0;
  const Counters all = counters();
  for (const auto& [name, count] : all.values()) sum += name.starts_with("refused.") ? count : 0;
  return sum;
}

}  // namespace curbstone::lidar_tool
