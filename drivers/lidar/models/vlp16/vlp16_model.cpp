#include "drivers/lidar/models/vlp16/vlp16_model.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "common/bus/levels.hpp"

namespace curbstone::lidar::models::vlp16 {

using decoding::Refusal;

const ModelTable kTable = {"vlp16", "Velodyne VLP-16", kDataPort, kPositionPort, kLasers, false};

namespace {

constexpr std::size_t kPps = 202;   // 0 absent, 1 synchronising, 2 locked, 3 error
constexpr std::size_t kNmea = 206;  // text, zero padded
constexpr int kPpsLocked = 2;
constexpr int kPpsError = 3;

const std::vector<LaserAngles>& checked(const std::vector<LaserAngles>& angles) {
  if (!angles.empty() && angles.size() != kLasers)
    throw std::runtime_error(fmt::format("angles_file: a VLP-16 has {} lasers, the file {}", kLasers, angles.size()));
  return angles;
}

}  // namespace

bool is_valid_gprmc(std::string_view text) {
  if (!text.starts_with("$GPRMC,")) return false;
  const std::size_t star = text.find('*');
  if (star == std::string_view::npos || star + 3 > text.size()) return false;
  unsigned sum = 0;
  for (const char c : text.substr(1, star - 1)) sum ^= static_cast<unsigned char>(c);
  const std::string expected = fmt::format("{:02X}", sum);
  const std::size_t status = text.find(',', 7);  // after the time
  return text.substr(star + 1, 2) == expected && text.substr(status + 1, 2) == "A,";
}

Vlp16Model::Vlp16Model(const ModelSettings& settings) : decoder_(settings.limits, checked(settings.angles)) {
  facts_.angles_known = true;
}

PacketKind Vlp16Model::kind_of(Sender sender) const {
  if (sender == Sender::kVlp16Position) return PacketKind::kInfo;
  return sender == Sender::kVlp16 || sender == Sender::kUnknown ? PacketKind::kPoints : PacketKind::kForeign;
}

Refusal Vlp16Model::decode(std::int64_t received, std::span<const std::uint8_t> bytes,
                           decoding::DecodedPacket& packet) {
  return decoder_.decode(received, bytes, packet);
}

Refusal Vlp16Model::read_info(std::int64_t received, std::span<const std::uint8_t> bytes) {
  (void)received;
  if (bytes.size() != kPositionSize) return Refusal::kLength;
  const int pps = bytes[kPps];
  if (pps > kPpsError) return Refusal::kPosition;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data() + kNmea), kPositionSize - kNmea);
  facts_.reported = true;
  set_level(facts_.values, "device.pps", pps);
  set_level(facts_.values, "device.pps_locked", pps == kPpsLocked ? 1 : 0);
  set_level(facts_.values, "device.dual_return", decoder_.dual_return() ? 1 : 0);
  set_level(facts_.values, "device.gprmc_locked", is_valid_gprmc(text) ? 1 : 0);
  facts_.faults.clear();
  if (pps == kPpsError)
    facts_.faults.emplace_back("the device reports an error of its PPS input: is the GPS's pulse there?");
  return Refusal::kNone;
}

}  // namespace curbstone::lidar::models::vlp16
