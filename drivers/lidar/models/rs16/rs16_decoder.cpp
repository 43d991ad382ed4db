#include "drivers/lidar/models/rs16/rs16_decoder.hpp"

#include <algorithm>
#include <cstring>

#include "drivers/lidar/decoding/block_steps.hpp"
#include "drivers/lidar/models/rs16/msop_packet.hpp"

namespace curbstone::lidar::models::rs16 {

using decoding::Refusal;

namespace {

constexpr std::uint16_t kNoReturn = 0xFFFF;  // as real devices send it; 0 is the manual's

Refusal check(const MsopPacket& packet) {
  if (packet.magic != robosense::kMsopMagic) return Refusal::kMagic;
  for (const MsopBlock& block : packet.blocks) {
    if (block.flag != MsopBlock::kFlag) return Refusal::kBlock;
    if (block.azimuth >= 36000) return Refusal::kAzimuth;
  }
  return Refusal::kNone;
}

/// The half of the block that holds the other return has the same: the shot had but one.
bool repeats_first(const MsopBlock& block, std::size_t record) {
  const MsopRecord& first = block.records[record - kLasers];
  const MsopRecord& second = block.records[record];
  return first.distance == second.distance && first.intensity == second.intensity;
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
  for (std::size_t i = 0; i < kRecords; ++i) {
    const std::size_t sequence = device.dual_return ? 0 : i / kLasers;
    times_[i] =
        static_cast<double>(sequence) * device.times.sequence + static_cast<double>(i % kLasers) * device.times.laser;
  }
  for (std::size_t i = 0; i < kLasers; ++i) {
    const double elevation = device.elevations[i];
    const auto lower = std::ranges::count_if(device.elevations, [&](double e) { return e < elevation; });
    lasers_[i] = decoding::laser_at(elevation, device.azimuths[i], 0.0, static_cast<std::uint8_t>(lower));
  }
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

  packet.clear();
  packet.stamp = robosense::utime_from(msop.time);
  if (packet.stamp) blind_zone_.next_stamp(*packet.stamp);
  if (!steps.steady) {
    const double lasts = kBlocksPerPacket * block_period_ * 1e6;
    if (packet.stamp && steps.gap)
      blind_zone_.suspect(*steps.gap, *packet.stamp, lasts,
                          lasts + (steps.gap->width / steps.mean - 1) * block_period_ * 1e6);
    return Refusal::kAzimuth;
  }
  packet.azimuth = azimuths[0];
  packet.rate = steps.mean / block_period_;
  packet.duration = spans.back().start + block_period_;
  decoding::PointWriter writer(limits_, kLensOffset, packet);
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    writer.block(0.01 * azimuths[b]);
    const double turned_a_second = 0.01 * spans[b].angle / block_period_;
    for (std::size_t r = 0; r < kRecords; ++r) {
      const MsopRecord& record = msop.blocks[b].records[r];
      if (device_.dual_return && r >= kLasers && repeats_first(msop.blocks[b], r)) continue;
      if (record.distance == 0 || record.distance == kNoReturn) {
        ++packet.no_return;
        continue;
      }
      writer.add(turned_a_second * times_[r], spans[b].start + times_[r], lasers_[r % kLasers],
                 record.distance * device_.distance_step, record.intensity);
    }
  }
  writer.finish();
  return Refusal::kNone;
}

}  // namespace curbstone::lidar::models::rs16
