#include "drivers/lidar/models/vlp16/vlp16_decoder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/lidar/decoding/block_steps.hpp"

namespace curbstone::lidar::models::vlp16 {

using decoding::Refusal;

namespace {

constexpr std::int64_t kHour = 3'600'000'000;             // us
constexpr std::int64_t kMaxPastHour = kHour + 1'000'000;  // us: values slightly above an hour occur

decoding::BlockRecords records_of(std::span<const std::uint8_t> block) {
  decoding::BlockRecords records;
  for (std::size_t i = 0; i < decoding::kRecordsPerBlock; ++i) {
    const auto record = block.subspan(4 + 3 * i, 3);
    records.distance[i] = read_little_endian<std::uint16_t>(record);
    records.intensity[i] = record[2];
  }
  return records;
}

using Azimuths = std::array<std::uint16_t, kBlocksPerPacket>;

/// Reads the azimuth of each firing, 0.01 deg. With two returns a firing has two blocks, of the same azimuth.
Refusal read_azimuths(std::span<const std::uint8_t> bytes, std::size_t blocks_a_firing, Azimuths& azimuths) {
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    if (bytes[kBlockSize * b] != 0xFF || bytes[kBlockSize * b + 1] != 0xEE) return Refusal::kBlock;
    const auto azimuth = read_little_endian<std::uint16_t>(bytes.subspan(kBlockSize * b + 2));
    if (azimuth >= 36000) return Refusal::kAzimuth;
    if (b % blocks_a_firing == 1 && azimuth != azimuths[b / 2]) return Refusal::kAzimuth;
    azimuths[b / blocks_a_firing] = azimuth;
  }
  return Refusal::kNone;
}

/// Two returns: if a shot has only one, both are equal.
void leave_out_repeats(const decoding::BlockRecords& first, decoding::BlockRecords& other) {
  for (std::size_t i = 0; i < decoding::kRecordsPerBlock; ++i) {
    if (other.distance[i] == first.distance[i] && other.intensity[i] == first.intensity[i]) other.leave_out(i);
  }
}

/// Adds the hour for which the result is nearest to `reference`.
std::int64_t nearest(std::int64_t past_hour, std::int64_t reference) {
  std::int64_t stamp = reference - reference % kHour + past_hour;
  if (stamp - reference > kHour / 2) stamp -= kHour;
  if (reference - stamp > kHour / 2) stamp += kHour;
  return stamp;
}

}  // namespace

Vlp16Decoder::Vlp16Decoder(const decoding::ReturnLimits& limits, const std::vector<LaserAngles>& angles) {
  auto rules = std::make_shared<decoding::PointRules>(decoding::PointRules{limits, {kDistanceStep}, 0.0, {}});
  std::array<LaserAngles, kLasers> all;
  for (std::size_t i = 0; i < kLasers; ++i) all[i] = angles.empty() ? LaserAngles{kElevations[i], 0.0} : angles[i];
  for (std::size_t i = 0; i < decoding::kRecordsPerBlock; ++i) {
    const std::size_t laser = i % kLasers;
    const double time = static_cast<double>(i / kLasers) * kSequencePeriod + static_cast<double>(laser) * kLaserPeriod;
    const auto& [elevation, azimuth] = all[laser];
    const auto lower = std::ranges::count_if(all, [&](const auto& a) { return a.elevation < all[laser].elevation; });
    rules->shots.set(i, time, {elevation, azimuth, kHeights[laser], static_cast<std::uint8_t>(lower)});
  }
  rules_ = std::move(rules);
}

Refusal Vlp16Decoder::decode(std::int64_t received, std::span<const std::uint8_t> bytes,
                             decoding::DecodedPacket& packet) {
  if (bytes.size() != kPacketSize) return Refusal::kLength;
  const std::uint8_t mode = bytes[kReturnMode];
  if (mode != kStrongest && mode != kLast && mode != kDual) return Refusal::kMode;
  const bool dual = mode == kDual;
  const std::size_t blocks_a_firing = dual ? 2 : 1;
  const std::size_t firings = kBlocksPerPacket / blocks_a_firing;

  Azimuths azimuths{};
  if (const Refusal refusal = read_azimuths(bytes, blocks_a_firing, azimuths); refusal != Refusal::kNone)
    return refusal;
  std::array<decoding::BlockSpan, kBlocksPerPacket> spans;
  const decoding::BlockSteps steps =
      decoding::block_steps(std::span(azimuths).first(firings), blind_zone_, kBlockPeriod, spans);

  packet.begin();
  const std::int64_t past_hour = read_little_endian<std::uint32_t>(bytes.subspan(kStamp));
  if (past_hour < kMaxPastHour) packet.stamp = resolve(past_hour, received);
  if (packet.stamp) blind_zone_.next_stamp(*packet.stamp);
  if (!steps.steady) {
    decoding::suspect_blind_zone(steps, packet.stamp, firings, kBlockPeriod, blind_zone_);
    return Refusal::kAzimuth;
  }
  dual_return_ = dual;
  spans[firings - 1].angle = spans[firings - 2].angle;
  packet.azimuth = azimuths[0];
  packet.rate = steps.mean / kBlockPeriod;
  packet.duration = spans[firings - 1].start + kBlockPeriod;
  decoding::PointWriter writer(rules_, packet);
  for (std::size_t f = 0; f < firings; ++f) {
    std::array<decoding::BlockRecords, 2> returns;
    for (std::size_t i = 0; i < blocks_a_firing; ++i)
      returns[i] = records_of(bytes.subspan(kBlockSize * (f * blocks_a_firing + i), kBlockSize));
    if (dual) leave_out_repeats(returns[0], returns[1]);
    writer.add({azimuths[f], 0.01 * spans[f].angle / kBlockPeriod, spans[f].start},
               std::span(returns).first(blocks_a_firing));
  }
  writer.finish();
  return Refusal::kNone;
}

std::int64_t Vlp16Decoder::resolve(std::int64_t past_hour, std::int64_t received) {
  // The reference continues from the last packet, so that a clock that is half an hour off does not change sides.
  const std::int64_t reference = last_stamp_ ? *last_stamp_ + (received - last_received_) : received;
  const std::int64_t stamp = nearest(past_hour, reference);
  // The extrapolation follows the times of receipt: a damaged stamp moves it by at most half an hour, and back.
  last_stamp_ = std::abs(stamp - reference) < kHour / 4 ? stamp : reference;
  last_received_ = received;
  return stamp;
}

}  // namespace curbstone::lidar::models::vlp16
