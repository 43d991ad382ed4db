#include "drivers/lidar/models/vlp16/vlp16_decoder.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/lidar/decoding/block_steps.hpp"

namespace curbstone::lidar::models::vlp16 {

using decoding::Refusal;

namespace {

constexpr std::int64_t kHour = 3'600'000'000;             // us
constexpr std::int64_t kLongestHour = kHour + 1'000'000;  // us: values a little above the hour occur

std::span<const std::uint8_t> record_of(std::span<const std::uint8_t> bytes, std::size_t block, std::size_t record) {
  return bytes.subspan(kBlockSize * block + 4 + 3 * record, 3);
}

/// To the hour in which it is nearest to `reference`.
std::int64_t nearest(std::int64_t past_hour, std::int64_t reference) {
  std::int64_t stamp = reference - reference % kHour + past_hour;
  if (stamp - reference > kHour / 2) stamp -= kHour;
  if (reference - stamp > kHour / 2) stamp += kHour;
  return stamp;
}

}  // namespace

Vlp16Decoder::Vlp16Decoder(const decoding::ReturnLimits& limits, const std::vector<LaserAngles>& angles)
    : limits_(limits) {
  std::array<LaserAngles, kLasers> all;
  for (std::size_t i = 0; i < kLasers; ++i) all[i] = angles.empty() ? LaserAngles{kElevations[i], 0.0} : angles[i];
  for (std::size_t i = 0; i < kLasers; ++i) {
    const auto lower = std::ranges::count_if(all, [&](const auto& a) { return a.elevation < all[i].elevation; });
    lasers_[i] = decoding::laser_at(all[i].elevation, all[i].azimuth, kHeights[i], static_cast<std::uint8_t>(lower));
  }
}

Refusal Vlp16Decoder::decode(std::int64_t received, std::span<const std::uint8_t> bytes,
                             decoding::DecodedPacket& packet) {
  if (bytes.size() != kPacketSize) return Refusal::kLength;
  const std::uint8_t mode = bytes[kReturnMode];
  if (mode != kStrongest && mode != kLast && mode != kDual) return Refusal::kMode;
  const bool dual = mode == kDual;
  const std::size_t blocks_a_firing = dual ? 2 : 1;
  const std::size_t firings = kBlocksPerPacket / blocks_a_firing;

  std::array<std::uint16_t, kBlocksPerPacket> azimuths{};
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    if (bytes[kBlockSize * b] != 0xFF || bytes[kBlockSize * b + 1] != 0xEE) return Refusal::kBlock;
    const auto azimuth = read_little_endian<std::uint16_t>(bytes.subspan(kBlockSize * b + 2));
    if (azimuth >= 36000) return Refusal::kAzimuth;
    if (dual && b % 2 == 1 && azimuth != azimuths[b / 2]) return Refusal::kAzimuth;  // the pair's second block
    azimuths[b / blocks_a_firing] = azimuth;
  }
  std::array<decoding::BlockSpan, kBlocksPerPacket> spans;
  const decoding::BlockSteps steps =
      decoding::block_steps(std::span(azimuths).first(firings), blind_zone_, kBlockPeriod, spans);

  packet.clear();
  const std::int64_t past_hour = read_little_endian<std::uint32_t>(bytes.subspan(kStamp));
  if (past_hour < kLongestHour) packet.stamp = resolve(past_hour, received);
  if (packet.stamp) blind_zone_.next_stamp(*packet.stamp);
  if (!steps.steady) {
    const double lasts = static_cast<double>(firings) * kBlockPeriod * 1e6;
    if (packet.stamp && steps.gap)
      blind_zone_.suspect(*steps.gap, *packet.stamp, lasts,
                          lasts + (steps.gap->width / steps.mean - 1) * kBlockPeriod * 1e6);
    return Refusal::kAzimuth;
  }
  dual_return_ = dual;
  spans[firings - 1].angle = spans[firings - 2].angle;
  packet.azimuth = azimuths[0];
  packet.rate = steps.mean / kBlockPeriod;
  packet.duration = spans[firings - 1].start + kBlockPeriod;
  decoding::PointWriter writer(limits_, 0.0, packet);
  const auto add = [&](std::span<const std::uint8_t> record, double turned_deg, double time, std::size_t laser) {
    const auto distance = read_little_endian<std::uint16_t>(record);
    if (distance == 0)
      ++packet.no_return;
    else
      writer.add(turned_deg, time, lasers_[laser], distance * kDistanceStep, record[2]);
  };
  for (std::size_t f = 0; f < firings; ++f) {
    writer.block(0.01 * azimuths[f]);
    for (std::size_t r = 0; r < kRecordsPerBlock; ++r) {
      const double time =
          static_cast<double>(r / kLasers) * kSequencePeriod + static_cast<double>(r % kLasers) * kLaserPeriod;
      const double turned_deg = 0.01 * spans[f].angle * (time / kBlockPeriod);
      const auto record = record_of(bytes, f * blocks_a_firing, r);
      add(record, turned_deg, spans[f].start + time, r % kLasers);
      if (!dual) continue;
      const auto other = record_of(bytes, f * blocks_a_firing + 1, r);
      if (!std::ranges::equal(record, other)) add(other, turned_deg, spans[f].start + time, r % kLasers);
    }
  }
  writer.finish();
  return Refusal::kNone;
}

std::int64_t Vlp16Decoder::resolve(std::int64_t past_hour, std::int64_t received) {
  // Where it goes on from the last packet, so that a clock half an hour off does not change sides.
  const std::int64_t reference = last_stamp_ ? *last_stamp_ + (received - last_received_) : received;
  const std::int64_t stamp = nearest(past_hour, reference);
  // The sum stays near the times of receipt: one damaged stamp moves it by no more than that hour's half, and back.
  last_stamp_ = std::abs(stamp - reference) < kHour / 4 ? stamp : reference;
  last_received_ = received;
  return stamp;
}

}  // namespace curbstone::lidar::models::vlp16
