#include "drivers/lidar/models/helios/helios_model.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "common/bus/levels.hpp"
#include "drivers/lidar/models/robosense/field_of_view.hpp"
#include "drivers/lidar/models/robosense/magic.hpp"

namespace curbstone::lidar::models::helios {

using decoding::Refusal;

namespace {

/// Of the lasers of a 16P, us: all values of nebula's table, and rs_driver's before 2024-03.
constexpr std::array<double, kRecords> kTimes16p = {0,        3.15e-6,  6.30e-6,  9.45e-6,  13.26e-6, 17.08e-6,
                                                    20.56e-6, 23.71e-6, 26.53e-6, 27.77e-6, 31.49e-6, 32.73e-6,
                                                    36.46e-6, 38.94e-6, 41.42e-6, 43.91e-6};

constexpr std::array<double, kRecords> even_times() {
  std::array<double, kRecords> times{};
  for (std::size_t i = 0; i < kRecords; ++i) times[i] = 1.73e-6 * static_cast<double>(i);
  return times;
}

}  // namespace

const Variant k16p = {
    {"helios16p", "RoboSense Helios 16P", robosense::kMsopPort, robosense::kDifopPort, 16, true, false}, 16, kTimes16p};
const Variant k32 = {
    {"helios32", "RoboSense Helios with 32 lasers", robosense::kMsopPort, robosense::kDifopPort, 32, true, false},
    32,
    even_times()};

HeliosModel::HeliosModel(const Variant& variant, const ModelSettings& settings)
    : variant_(variant), settings_(settings), decoder_(variant, settings.limits, settings.distance_step) {
  if (settings.angles.empty()) return;
  if (settings.angles.size() != variant.lasers)
    throw std::runtime_error(fmt::format("angles_file: a {} has {} lasers, the file {}", variant.table.title,
                                         variant.lasers, settings.angles.size()));
  use({});
}

PacketKind HeliosModel::kind_of(Sender sender) const {
  const Sender own = variant_.lasers == 16 ? Sender::kHelios16p : Sender::kHelios32;
  if (sender == Sender::kHeliosInfo || sender == Sender::kRs16Info) return PacketKind::kInfo;
  // kHelios: its type byte is shared; its device information has the number of lasers.
  const bool points = sender == own || sender == Sender::kHelios || sender == Sender::kUnknown;
  return points ? PacketKind::kPoints : PacketKind::kForeign;
}

Refusal HeliosModel::decode(std::int64_t received, std::span<const std::uint8_t> bytes,
                            decoding::DecodedPacket& packet) {
  (void)received;
  const Refusal refusal = decoder_.decode(bytes, packet);
  return refusal == Refusal::kNone && !facts_.angles_known ? Refusal::kNoAngles : refusal;
}

Refusal HeliosModel::read_info(std::int64_t received, std::span<const std::uint8_t> bytes) {
  (void)received;
  const DifopResult result = parse_difop(bytes);
  if (result.refusal != Refusal::kNone) return result.refusal;
  const bool fits = result.info.lasers == static_cast<int>(variant_.lasers);
  if (!fits && (result.info.lasers != 0 || settings_.angles.empty())) return Refusal::kDifopAngles;
  const bool alone = settings_.only_info && !facts_.reported;
  if (alone && settings_.angles.empty() && !is_plausible(result.info, result.status)) return Refusal::kDifopAngles;
  identity_.offer(result.status.identity);
  const bool agreed = info_.offer(result.info);
  if (agreed || alone) use(result.info);
  if (info_.value() || facts_.reported || alone) report_info(info_.value().value_or(result.info), result.status);
  return Refusal::kNone;
}

void HeliosModel::use(DeviceInfo info) {
  if (!settings_.angles.empty()) std::copy(settings_.angles.begin(), settings_.angles.end(), info.angles.begin());
  decoder_.set_device(info);
  facts_.angles_known = true;
}

void HeliosModel::report_info(const DeviceInfo& info, const DeviceStatus& status) {
  facts_.reported = true;
  facts_.field_of_view = robosense::field_of_view(info.fov_start, info.fov_end);
  facts_.values = {};
  set_level(facts_.values, "device.rpm_set", info.rpm);
  set_level(facts_.values, "device.rpm", status.rpm);
  set_level(facts_.values, "device.pps_locked", status.pps_locked ? 1 : 0);
  set_level(facts_.values, "device.gprmc_locked", status.gprmc_locked ? 1 : 0);
  set_level(facts_.values, "device.sync_mode", status.sync_mode);
  set_level(facts_.values, "device.sync_status", status.sync_status);
  set_level(facts_.values, "device.dual_return", info.dual_return ? 1 : 0);
  facts_.faults.clear();
  if (const auto fault = speed_.check(info.rpm, status.rpm)) facts_.faults.push_back(*fault);
  facts_.identity = identity_.value().value_or(Identity{});
  report(facts_.identity, facts_.values);
}

}  // namespace curbstone::lidar::models::helios
