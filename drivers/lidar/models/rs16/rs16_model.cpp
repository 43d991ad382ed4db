#include "drivers/lidar/models/rs16/rs16_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "common/bus/levels.hpp"
#include "drivers/lidar/models/robosense/field_of_view.hpp"

namespace curbstone::lidar::models::rs16 {

using decoding::Refusal;

const ModelTable kTable = {"rs16", "RoboSense RS-LiDAR-16", robosense::kMsopPort, robosense::kDifopPort, kLasers};

Rs16Model::Rs16Model(const ModelSettings& settings) : settings_(settings), decoder_(settings.limits) {
  if (!settings.angles.empty() && settings.angles.size() != kLasers)
    throw std::runtime_error(
        fmt::format("angles_file: an RS-LiDAR-16 has {} lasers, the file {}", kLasers, settings.angles.size()));
  decoder_.set_device(with_settings({}));
  facts_.angles_known = !settings.angles.empty();
}

PacketKind Rs16Model::kind_of(Sender sender) const {
  if (sender == Sender::kRs16Info) return PacketKind::kInfo;
  return sender == Sender::kRs16 || sender == Sender::kUnknown ? PacketKind::kPoints : PacketKind::kForeign;
}

Refusal Rs16Model::decode(std::int64_t received, std::span<const std::uint8_t> bytes, decoding::DecodedPacket& packet) {
  (void)received;
  const Refusal refusal = decoder_.decode(bytes, packet);
  if (refusal != Refusal::kNone) return refusal;
  if (settings_.wait_for_info && !facts_.angles_known) return Refusal::kNoAngles;
  return has_two_returns(packet) ? Refusal::kMode : Refusal::kNone;
}

/// A packet does not contain the number of returns, and the device reports it only once a second. But a packet with two
/// returns takes half the time that the decoder assumes for one return, while the azimuth advances as far as computed
/// for the whole packet. Until the device has reported the mode, such packets are decoded wrongly.
bool Rs16Model::has_two_returns(const decoding::DecodedPacket& packet) {
  constexpr int kSure = 2;
  if (decoder_.device().dual_return || !packet.stamp) return false;
  const double took = static_cast<double>(*packet.stamp - std::exchange(stamp_, *packet.stamp)) * 1e-6;
  const int turned = (packet.azimuth - std::exchange(azimuth_, packet.azimuth) + 36000) % 36000;
  const bool half = std::abs(took - 0.5 * packet.duration) < 0.1 * packet.duration;
  const double whole = packet.rate * packet.duration;
  const bool as_far = std::abs(turned - whole) < 0.2 * whole;
  halves_ = half && as_far ? std::min(halves_ + 1, kSure) : 0;
  return halves_ == kSure;
}

Refusal Rs16Model::read_info(std::int64_t received, std::span<const std::uint8_t> bytes) {
  (void)received;
  const DifopResult result = parse_difop(bytes);
  if (result.refusal != Refusal::kNone) return result.refusal;
  identity_.offer(result.status.identity);
  if (info_.offer(result.info)) decoder_.set_device(with_settings(result.info));
  if (info_.value()) report_info(*info_.value(), result.status);
  return Refusal::kNone;
}

DeviceInfo Rs16Model::with_settings(DeviceInfo info) const {
  info.distance_step = settings_.distance_step.value_or(info.distance_step);
  for (std::size_t i = 0; i < settings_.angles.size(); ++i) {
    info.elevations[i] = settings_.angles[i].elevation;
    info.azimuths[i] = settings_.angles[i].azimuth;
    info.calibrated = true;
  }
  return info;
}

void Rs16Model::report_info(const DeviceInfo& info, const DeviceStatus& status) {
  facts_.reported = true;
  facts_.field_of_view = robosense::field_of_view(info.fov_start, info.fov_end);
  facts_.angles_known = info.calibrated || !settings_.angles.empty();
  facts_.values = {};
  set_level(facts_.values, "device.rpm_set", info.rpm);
  set_level(facts_.values, "device.rpm", status.rpm);
  set_level(facts_.values, "device.pps_locked", status.pps_locked ? 1 : 0);
  set_level(facts_.values, "device.gprmc_locked", status.gprmc_locked ? 1 : 0);
  set_level(facts_.values, "device.dual_return", info.dual_return ? 1 : 0);
  constexpr std::array<LevelName, 4> kSupplies = {"device.supply_5v_mv", "device.supply_3v3_mv", "device.supply_2v5_mv",
                                                  "device.supply_1v2_mv"};
  for (std::size_t i = 0; i < kSupplies.size(); ++i) {
    if (status.millivolts[i] != 0) set_level(facts_.values, kSupplies[i], status.millivolts[i]);
  }
  constexpr std::array<LevelName, 4> kTemperatures = {"device.temperature_1_mdeg", "device.temperature_2_mdeg",
                                                      "device.temperature_3_mdeg", "device.temperature_4_mdeg"};
  for (std::size_t i = 0; i < kTemperatures.size(); ++i)
    set_level(facts_.values, kTemperatures[i], std::lround(status.temperatures[i] * 1000));
  facts_.faults.clear();
  if (const auto fault = speed_.check(info.rpm, status.rpm)) facts_.faults.push_back(*fault);
  facts_.identity = identity_.value().value_or(Identity{});
  report(facts_.identity, facts_.values);
}

}  // namespace curbstone::lidar::models::rs16
