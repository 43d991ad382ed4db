#include "drivers/lidar/models/helios/helios_decoder.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "drivers/lidar/decoding/block_steps.hpp"
#include "drivers/lidar/decoding/record_bytes.hpp"
#include "drivers/lidar/models/helios/msop_packet.hpp"

namespace curbstone::lidar::models::helios {

using decoding::Refusal;

namespace {

constexpr std::uint16_t kNoReturn = 0xFFFF;
constexpr int kUnitChangesAfter = 10;                          // consecutive packets
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

/// Two returns: if a shot has only one, both are equal. `apart`: records from one return to the other.
void leave_out_repeats(const decoding::BlockRecords& first, decoding::BlockRecords& other, std::size_t apart) {
  for (std::size_t i = apart; i < kRecords; ++i) {
    const std::size_t of_first = i - apart;
    if (other.distance[i] == first.distance[of_first] && other.intensity[i] == first.intensity[of_first])
      other.leave_out(i);
  }
}

using Azimuths = std::array<std::uint16_t, kBlocksPerPacket>;

/// Reads the azimuth of each firing, 0.01 deg. False if the two blocks of a firing differ.
bool read_azimuths(const MsopPacket& msop, std::size_t blocks_a_firing, Azimuths& azimuths) {
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    if (b % blocks_a_firing == 1 && msop.blocks[b].azimuth != azimuths[b / 2]) return false;
    azimuths[b / blocks_a_firing] = msop.blocks[b].azimuth;
  }
  return true;
}

}  // namespace

HeliosDecoder::HeliosDecoder(const Variant& variant, const decoding::ReturnLimits& limits,
                             std::optional<double> distance_step)
    : variant_(variant), distance_step_(distance_step), next_rules_{limits, {0, kNoReturn}, kLensOffset, {}} {}

void HeliosDecoder::set_device(const DeviceInfo& device) {
  blind_zone_.set_field_of_view(device.fov_start, device.fov_end);
  dual_return_ = device.dual_return;
  const std::span<const LaserAngles> angles(device.angles.data(), variant_.lasers);
  for (std::size_t i = 0; i < kRecords; ++i) {
    const std::size_t laser = i % variant_.lasers;
    const std::size_t sequence = dual_return_ ? 0 : i / variant_.lasers;
    const double time = variant_.times[laser] + static_cast<double>(sequence) * kSequencePeriod;
    const double elevation = angles[laser].elevation;
    const auto lower = std::ranges::count_if(angles, [&](const auto& a) { return a.elevation < elevation; });
    next_rules_.shots.set(i, time, {elevation, angles[laser].azimuth, 0.0, static_cast<std::uint8_t>(lower)});
  }
  rules_.reset();
}

bool HeliosDecoder::unit_is_credible(std::uint8_t unit) {
  if (unit > MsopPacket::k2_5mm) return false;
  if (!unit_) unit_ = unit;
  other_units_ = unit == *unit_ ? 0 : other_units_ + 1;
  if (other_units_ >= kUnitChangesAfter) unit_ = unit;
  return unit == *unit_;
}

const std::shared_ptr<const decoding::PointRules>& HeliosDecoder::rules_in(double distance_step) {
  if (!rules_ || rules_->unit.step != distance_step) {
    next_rules_.unit.step = distance_step;
    rules_ = std::make_shared<decoding::PointRules>(next_rules_);
  }
  return rules_;
}

HeliosDecoder::Firings HeliosDecoder::firings() const {
  const bool sixteen = variant_.lasers == kRecords / 2;
  const std::size_t blocks = dual_return_ && !sixteen ? 2 : 1;
  const std::size_t sequences = sixteen && !dual_return_ ? 2 : 1;
  return {blocks, kBlocksPerPacket / blocks, static_cast<double>(sequences) * kSequencePeriod};
}

/// The returns of a firing, without those that are repeated.
std::array<decoding::BlockRecords, 2> HeliosDecoder::returns_of(std::span<const MsopBlock> blocks) const {
  std::array<decoding::BlockRecords, 2> returns;
  for (std::size_t i = 0; i < blocks.size(); ++i) returns[i] = decoding::records_of(blocks[i].records);
  if (has_returns_in_halves())
    leave_out_repeats(returns[0], returns[0], variant_.lasers);
  else if (dual_return_)
    leave_out_repeats(returns[0], returns[1], 0);
  return returns;
}

Refusal HeliosDecoder::decode(std::span<const std::uint8_t> bytes, decoding::DecodedPacket& packet) {
  if (bytes.size() != sizeof(MsopPacket)) return Refusal::kLength;
  MsopPacket msop;
  std::memcpy(&msop, bytes.data(), sizeof msop);
  if (const Refusal refusal = check(msop); refusal != Refusal::kNone) return refusal;
  if (!unit_is_credible(msop.distance_unit)) return Refusal::kBlock;
  const double distance_step = distance_step_.value_or(*unit_ == MsopPacket::k2_5mm ? 0.0025 : 0.005);

  const auto [blocks, count, period] = firings();
  Azimuths azimuths{};
  if (!read_azimuths(msop, blocks, azimuths)) return Refusal::kAzimuth;
  std::array<decoding::BlockSpan, kBlocksPerPacket> spans;
  const decoding::BlockSteps steps =
      decoding::block_steps(std::span(azimuths).first(count), blind_zone_, period, spans);

  packet.begin();
  packet.stamp = stamp_of(msop);
  if (packet.stamp) blind_zone_.next_stamp(*packet.stamp);
  if (!steps.steady) {
    decoding::suspect_blind_zone(steps, packet.stamp, count, period, blind_zone_);
    return Refusal::kAzimuth;
  }
  packet.azimuth = azimuths[0];
  packet.rate = steps.mean / period;
  packet.duration = spans[count - 1].start + period;
  decoding::PointWriter writer(rules_in(distance_step), packet);
  for (std::size_t f = 0; f < count; ++f) {
    const auto returns = returns_of(std::span(msop.blocks).subspan(f * blocks, blocks));
    writer.add({azimuths[f], 0.01 * spans[f].angle / period, spans[f].start}, std::span(returns).first(blocks));
  }
  writer.finish();
  return Refusal::kNone;
}

}  // namespace curbstone::lidar::models::helios
