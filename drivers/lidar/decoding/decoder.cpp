#include "drivers/lidar/decoding/decoder.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "drivers/lidar/decoding/block_spans.hpp"
#include "drivers/lidar/packet/msop_packet.hpp"

namespace curbstone::lidar::decoding {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::size_t kRecords = packet::kSequencesPerBlock * packet::kLasers;

constexpr std::array<double, kRecords> record_times() {
  std::array<double, kRecords> times{};
  for (std::size_t i = 0; i < kRecords; ++i) {
    times[i] = static_cast<double>(i / packet::kLasers) * packet::kSequencePeriod +
               static_cast<double>(i % packet::kLasers) * packet::kLaserPeriod;
  }
  return times;
}
constexpr std::array<double, kRecords> kRecordTimes = record_times();  // s after the block's first shot

packet::Refusal check(const packet::MsopPacket& packet) {
  if (packet.magic != packet::kMsopMagic) {
    const bool helios = std::equal(packet.magic.begin(), packet.magic.begin() + 4, "\x55\xAA\x05\x5A",
                                   [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); });
    return helios ? packet::Refusal::kHelios16p : packet::Refusal::kMagic;
  }
  for (const packet::MsopBlock& block : packet.blocks) {
    if (block.flag != packet::MsopBlock::kFlag) return packet::Refusal::kBlock;
    if (block.azimuth >= 36000) return packet::Refusal::kAzimuth;
  }
  return packet::Refusal::kNone;
}

void clear(DecodedPacket& packet) {
  packet.out_of_range = 0;
  for (auto* values : {&packet.x, &packet.y, &packet.z, &packet.time_offset}) values->clear();
  packet.intensity.clear();
  packet.ring.clear();
}

}  // namespace

Rs16Decoder::Rs16Decoder(const DecoderOptions& options) : options_(options) {
  set_device(packet::DeviceInfo{});
}

void Rs16Decoder::set_device(const packet::DeviceInfo& device) {
  device_ = device;
  for (std::size_t i = 0; i < packet::kLasers; ++i) {
    const double elevation = device.elevations[i];
    const auto lower = std::ranges::count_if(device.elevations, [&](double e) { return e < elevation; });
    lasers_[i] = {std::cos(elevation * kDegree), std::sin(elevation * kDegree), static_cast<std::uint8_t>(lower)};
  }
}

packet::Refusal Rs16Decoder::decode(std::span<const std::uint8_t> bytes, DecodedPacket& packet) const {
  if (bytes.size() != sizeof(packet::MsopPacket)) return packet::Refusal::kLength;
  packet::MsopPacket msop;
  std::memcpy(&msop, bytes.data(), sizeof msop);
  if (const packet::Refusal refusal = check(msop); refusal != packet::Refusal::kNone) return refusal;
  if (device_.dual_return) return packet::Refusal::kDualReturn;

  std::array<std::uint16_t, packet::kBlocksPerPacket> azimuths;
  std::ranges::transform(msop.blocks, azimuths.begin(), [](const packet::MsopBlock& block) { return block.azimuth; });
  const double step = mean_block_step(azimuths, device_.rpm / 60.0 * 36000.0 * packet::kBlockPeriod);
  std::array<BlockSpan, packet::kBlocksPerPacket> spans;
  block_spans(azimuths, step, packet::kBlockPeriod, spans);

  clear(packet);
  packet.stamp = packet::utime_from(msop.time);
  packet.azimuth = azimuths[0];
  packet.rate = step / packet::kBlockPeriod;
  packet.duration = spans.back().start + packet::kBlockPeriod;
  for (std::size_t b = 0; b < packet::kBlocksPerPacket; ++b) {
    for (std::size_t r = 0; r < kRecords; ++r) {
      const packet::MsopRecord& record = msop.blocks[b].records[r];
      if (record.distance == 0) continue;
      const double azimuth = 0.01 * (azimuths[b] + spans[b].angle * (kRecordTimes[r] / packet::kBlockPeriod));
      add_record(azimuth, spans[b].start + kRecordTimes[r], lasers_[r % packet::kLasers],
                 record.distance * device_.distance_step, record.intensity, packet);
    }
  }
  return packet::Refusal::kNone;
}

void Rs16Decoder::add_record(double azimuth_deg, double time, const Laser& laser, double range, std::uint8_t intensity,
                             DecodedPacket& packet) const {
  if (range < options_.min_range || range > options_.max_range) {
    ++packet.out_of_range;
    return;
  }
  const double azimuth = azimuth_deg * kDegree;
  const double outward = range * laser.cos + packet::kLensOffset;
  packet.x.push_back(static_cast<float>(outward * std::cos(azimuth)));
  packet.y.push_back(static_cast<float>(-outward * std::sin(azimuth)));
  packet.z.push_back(static_cast<float>(range * laser.sin));
  packet.time_offset.push_back(static_cast<float>(time));
  packet.intensity.push_back(intensity);
  packet.ring.push_back(laser.ring);
}

}  // namespace curbstone::lidar::decoding
