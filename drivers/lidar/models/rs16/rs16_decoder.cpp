#include "drivers/lidar/models/rs16/rs16_decoder.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "drivers/lidar/decoding/block_steps.hpp"
#include "drivers/lidar/decoding/record_bytes.hpp"
#include "drivers/lidar/models/rs16/msop_packet.hpp"

namespace curbstone::lidar::models::rs16 {

using decoding::Refusal;

namespace {

constexpr std::uint16_t kNoReturn = 0xFFFF;  // as sent by real devices; the manual says 0

Refusal check(const MsopPacket& packet) {
  if (packet.magic != robosense::kMsopMagic) return Refusal::kMagic;
  for (const MsopBlock& block : packet.blocks) {
    if (block.flag != MsopBlock::kFlag) return Refusal::kBlock;
    if (block.azimuth >= 36000) return Refusal::kAzimuth;
  }
  return Refusal::kNone;
}

/// Two returns: if a shot has only one, the half of the block for the other return repeats it.
void leave_out_repeats(decoding::BlockRecords& records) {
  for (std::size_t i = kLasers; i < decoding::kRecordsPerBlock; ++i) {
    const std::size_t first = i - kLasers;
    if (records.distance[i] == records.distance[first] && records.intensity[i] == records.intensity[first])
      records.leave_out(i);
  }
}

}  // namespace

Rs16Decoder::Rs16Decoder(const decoding::ReturnLimits& limits) : limits_(limits) {
  set_device(DeviceInfo{});
}

void Rs16Decoder::set_device(const DeviceInfo& device) {
  device_ = device;
  blind_zone_.set_field_of_view(device.fov_start, device.fov_end);
  const int sequences = device.dual_return ? 1 : kSequencesPerBlock;
  block_period_ = sequences * device.times.sequence;
  auto rules = std::make_shared<decoding::PointRules>(
      decoding::PointRules{limits_, {device.distance_step, kNoReturn}, kLensOffset, {}});
  for (std::size_t i = 0; i < decoding::kRecordsPerBlock; ++i) {
    const std::size_t sequence = device.dual_return ? 0 : i / kLasers;
    const std::size_t laser = i % kLasers;
    const double time =
        static_cast<double>(sequence) * device.times.sequence + static_cast<double>(laser) * device.times.laser;
    const double elevation = device.elevations[laser];
    const auto lower = std::ranges::count_if(device.elevations, [&](double e) { return e < elevation; });
    rules->shots.set(i, time, {elevation, device.azimuths[laser], 0.0, static_cast<std::uint8_t>(lower)});
  }
  rules_ = std::move(rules);
}

Refusal Rs16Decoder::decode(std::span<const std::uint8_t> bytes, decoding::DecodedPacket& packet) {
  if (bytes.size() != sizeof(MsopPacket)) return Refusal::kLength;
  MsopPacket msop;
  std::memcpy(&msop, bytes.data(), sizeof msop);
  if (const Refusal refusal = check(msop); refusal != Refusal::kNone) return refusal;

  std::array<std::uint16_t, kBlocksPerPacket> azimuths;
  std::ranges::transform(msop.blocks, azimuths.begin(), [](const MsopBlock& block) { return block.azimuth; });
  std::array<decoding::BlockSpan, kBlocksPerPacket> spans;
  const decoding::BlockSteps steps = decoding::block_steps(azimuths, blind_zone_, block_period_, spans);

  packet.begin();
  packet.stamp = robosense::utime_from(msop.time);
  if (packet.stamp) blind_zone_.next_stamp(*packet.stamp);
  if (!steps.steady) {
    decoding::suspect_blind_zone(steps, packet.stamp, kBlocksPerPacket, block_period_, blind_zone_);
    return Refusal::kAzimuth;
  }
  packet.azimuth = azimuths[0];
  packet.rate = steps.mean / block_period_;
  packet.duration = spans.back().start + block_period_;
  decoding::PointWriter writer(rules_, packet);
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    decoding::BlockRecords records = decoding::records_of(msop.blocks[b].records);
    if (device_.dual_return) leave_out_repeats(records);
    writer.add({azimuths[b], 0.01 * spans[b].angle / block_period_, spans[b].start}, records);
  }
  writer.finish();
  return Refusal::kNone;
}

}  // namespace curbstone::lidar::models::rs16
