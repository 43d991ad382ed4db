#include "drivers/lidar/models/helios/helios_decoder.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "drivers/lidar/decoding/block_steps.hpp"
#include "drivers/lidar/models/helios/msop_packet.hpp"

namespace curbstone::lidar::models::helios {

using decoding::Refusal;

namespace {

constexpr std::uint16_t kNoReturn = 0xFFFF;
constexpr int kUnitChangesAfter = 10;                          // packets in a row
constexpr std::uint64_t kLastSecond = std::uint64_t{1} << 40;  // beyond any clock

Refusal check(const MsopPacket& packet) {
  if (packet.magic != robosense::kHeliosMagic) return Refusal::kMagic;
  for (const MsopBlock& block : packet.blocks) {
    if (block.flag != MsopBlock::kFlag) return Refusal::kBlock;
    if (block.azimuth >= 36000) return Refusal::kAzimuth;
  }
  return Refusal::kNone;
}

std::optional<std::int64_t> stamp_of(const MsopPacket& packet) {
  if (packet.seconds >= kLastSecond || packet.microseconds >= 1'000'000) return std::nullopt;
  return static_cast<std::int64_t>(std::uint64_t{packet.seconds}) * 1'000'000 + std::uint32_t{packet.microseconds};
}

bool same(const MsopRecord& a, const MsopRecord& b) {
  return a.distance == b.distance && a.intensity == b.intensity;
}

}  // namespace

HeliosDecoder::HeliosDecoder(const Variant& variant, const decoding::ReturnLimits& limits,
                             std::optional<double> distance_step)
    : variant_(variant), limits_(limits), distance_step_(distance_step) {}

void HeliosDecoder::set_device(const DeviceInfo& device) {
  blind_zone_.set_field_of_view(device.fov_start, device.fov_end);
  dual_return_ = device.dual_return;
  const std::span<const LaserAngles> angles(device.angles.data(), variant_.lasers);
  for (std::size_t i = 0; i < variant_.lasers; ++i) {
    const double elevation = angles[i].elevation;
    const auto lower = std::ranges::count_if(angles, [&](const auto& a) { return a.elevation < elevation; });
    lasers_[i] = decoding::laser_at(elevation, angles[i].azimuth, 0.0, static_cast<std::uint8_t>(lower));
  }
}

bool HeliosDecoder::unit_is_credible(std::uint8_t unit) {
  if (unit > MsopPacket::k2_5mm) return false;
  if (!unit_) unit_ = unit;
  other_units_ = unit == *unit_ ? 0 : other_units_ + 1;
  if (other_units_ >= kUnitChangesAfter) unit_ = unit;
  return unit == *unit_;
}

Refusal HeliosDecoder::decode(std::span<const std::uint8_t> bytes, decoding::DecodedPacket& packet) {
  if (bytes.size() != sizeof(MsopPacket)) return Refusal::kLength;
  MsopPacket msop;
  std::memcpy(&msop, bytes.data(), sizeof msop);
  if (const Refusal refusal = check(msop); refusal != Refusal::kNone) return refusal;
  if (!unit_is_credible(msop.distance_unit)) return Refusal::kBlock;
  const double distance_step = distance_step_.value_or(*unit_ == MsopPacket::k2_5mm ? 0.0025 : 0.005);

  // A firing: the blocks of one azimuth, and the sequences in a block.
  const bool sixteen = variant_.lasers == kRecords / 2;
  const std::size_t blocks_a_firing = dual_return_ && !sixteen ? 2 : 1;
  const std::size_t sequences = sixteen && !dual_return_ ? 2 : 1;
  const std::size_t firings = kBlocksPerPacket / blocks_a_firing;
  const double period = static_cast<double>(sequences) * kSequencePeriod;
  std::array<std::uint16_t, kBlocksPerPacket> azimuths{};
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    if (b % blocks_a_firing == 1 && msop.blocks[b].azimuth != azimuths[b / 2]) return Refusal::kAzimuth;
    azimuths[b / blocks_a_firing] = msop.blocks[b].azimuth;
  }
  std::array<decoding::BlockSpan, kBlocksPerPacket> spans;
  const decoding::BlockSteps steps =
      decoding::block_steps(std::span(azimuths).first(firings), blind_zone_, period, spans);

  packet.clear();
  packet.stamp = stamp_of(msop);
  if (packet.stamp) blind_zone_.next_stamp(*packet.stamp);
  if (!steps.steady) {
    const double lasts = static_cast<double>(firings) * period * 1e6;
    if (packet.stamp && steps.gap)
      blind_zone_.suspect(*steps.gap, *packet.stamp, lasts, lasts + (steps.gap->width / steps.mean - 1) * period * 1e6);
    return Refusal::kAzimuth;
  }
  packet.azimuth = azimuths[0];
  packet.rate = steps.mean / period;
  packet.duration = spans[firings - 1].start + period;
  decoding::PointWriter writer(limits_, kLensOffset, packet);
  for (std::size_t f = 0; f < firings; ++f) {
    writer.block(0.01 * azimuths[f]);
    const MsopBlock& first = msop.blocks[f * blocks_a_firing];
    const MsopBlock& last = msop.blocks[f * blocks_a_firing + blocks_a_firing - 1];
    for (std::size_t r = 0; r < kRecords; ++r) {
      const std::size_t laser = r % variant_.lasers;
      const bool second_return = sixteen && dual_return_ && r >= variant_.lasers;
      const double time =
          variant_.times[laser] + (second_return ? 0.0 : static_cast<double>(r / variant_.lasers) * kSequencePeriod);
      const double turned_deg = 0.01 * spans[f].angle * (time / period);
      const auto add = [&](const MsopRecord& record) {
        if (record.distance == 0 || record.distance == kNoReturn) {
          ++packet.no_return;
        } else {
          writer.add(turned_deg, spans[f].start + time, lasers_[laser], record.distance * distance_step,
                     record.intensity);
        }
      };
      if (second_return && same(first.records[r], first.records[laser])) continue;
      add(first.records[r]);
      if (blocks_a_firing == 2 && !same(first.records[r], last.records[r])) add(last.records[r]);
    }
  }
  writer.finish();
  return Refusal::kNone;
}

}  // namespace curbstone::lidar::models::helios
