#include "drivers/imu/xsens/mtdata2.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/bytes/big_endian.hpp"
#include "common/geometry/geometry.hpp"

namespace curbstone::imu::xsens {

namespace {

// Ids without their low nibble: bits 2..3 are the coordinate system, 0..1 the precision.
constexpr std::uint16_t kTypeMask = 0xF8F0;
constexpr std::uint16_t kTemperature = 0x0810;
constexpr std::uint16_t kPacketCounter = 0x1020;
constexpr std::uint16_t kSampleTimeFine = 0x1060;
constexpr std::uint16_t kQuaternion = 0x2010;
constexpr std::uint16_t kEulerAngles = 0x2030;
constexpr std::uint16_t kDeltaVelocity = 0x4010;
constexpr std::uint16_t kAcceleration = 0x4020;
constexpr std::uint16_t kRateOfTurn = 0x8020;
constexpr std::uint16_t kDeltaRotation = 0x8030;
constexpr std::uint16_t kStatusByte = 0xE010;
constexpr std::uint16_t kStatusWord = 0xE020;

constexpr double kMaxAcceleration = 2000;  // m/s^2: 200 g, the widest range on the market
constexpr double kMaxAngularRate = 100;    // rad/s: 5700 deg/s

constexpr std::array<std::size_t, 4> kNumberSize = {4, 4, 6, 8};

double number(std::uint16_t id, std::span<const std::uint8_t> bytes) {
  switch (id & 3) {
    case 0:
      return static_cast<double>(std::bit_cast<float>(read_big_endian<std::uint32_t>(bytes)));
    case 1:  // 12.20
      return std::ldexp(static_cast<double>(static_cast<std::int32_t>(read_big_endian<std::uint32_t>(bytes))), -20);
    case 2: {  // 16.32: the fraction comes first
      const auto fraction = read_big_endian<std::uint32_t>(bytes);
      const auto integer = static_cast<std::int16_t>(read_big_endian<std::uint16_t>(bytes.subspan(4)));
      return integer + std::ldexp(static_cast<double>(fraction), -32);
    }
    default:
      return std::bit_cast<double>(read_big_endian<std::uint64_t>(bytes));
  }
}

struct Item {
  std::uint16_t id;
  std::span<const std::uint8_t> data;
};

/// Whether it is a denormal float32, smaller than any other but zero: no sensor measures that, so it is not a
/// measurement.
bool is_denormal(double v) {
  return v != 0 && std::abs(v) < static_cast<double>(std::numeric_limits<float>::min());
}

/// N finite numbers in the item's precision, each of at most `limit`; otherwise empty, and counted.
template <std::size_t N>
std::optional<std::array<double, N>> numbers(const Item& item, double limit, Counters& counters) {
  const std::size_t size = kNumberSize[item.id & 3];
  if (item.data.size() != N * size) {
    counters.add("refused.item_size");
    return {};
  }
  std::array<double, N> values;
  for (std::size_t i = 0; i < N; ++i) values[i] = number(item.id, item.data.subspan(i * size));
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
    counters.add("refused.not_finite");
    return {};
  }
  if (!std::all_of(values.begin(), values.end(), [&](double v) { return std::abs(v) <= limit && !is_denormal(v); })) {
    counters.add("refused.range");
    return {};
  }
  return values;
}

template <class Number>
std::optional<Number> integer(const Item& item, Counters& counters) {
  if (item.data.size() == sizeof(Number)) return read_big_endian<Number>(item.data);
  counters.add("refused.item_size");
  return {};
}

std::optional<std::array<double, 4>> unit_quaternion(const Item& item, Counters& counters) {
  auto q = numbers<4>(item, 2.0, counters);
  if (!q) return q;
  const double norm = std::hypot(std::hypot((*q)[0], (*q)[1]), std::hypot((*q)[2], (*q)[3]));
  if (std::abs(norm - 1.0) > 0.01) {
    counters.add("refused.range");
    return {};
  }
  for (double& component : *q) component /= norm;
  return q;
}

/// From roll, pitch, yaw in degrees, unlike the rate of turn in the same message.
std::optional<std::array<double, 4>> quaternion_of_euler(const Item& item, Counters& counters) {
  const auto degrees = numbers<3>(item, 360.0, counters);
  if (!degrees) return {};
  constexpr double kRadians = std::numbers::pi / 180;
  const Eigen::Quaterniond q(
      rotation_from_rpy((*degrees)[0] * kRadians, (*degrees)[1] * kRadians, (*degrees)[2] * kRadians));
  return std::array{q.w(), q.x(), q.y(), q.z()};
}

void decode_item(const Item& item, MtData2& result, Counters& counters) {
  switch (item.id & kTypeMask) {
    case kPacketCounter:
      result.packet_counter = integer<std::uint16_t>(item, counters);
      break;
    case kSampleTimeFine:
      result.sample_time_fine = integer<std::uint32_t>(item, counters);
      break;
    case kAcceleration:
      result.acceleration = numbers<3>(item, kMaxAcceleration, counters);
      break;
    case kRateOfTurn:
      result.angular_rate = numbers<3>(item, kMaxAngularRate, counters);
      break;
    case kDeltaVelocity:
      result.delta_velocity = numbers<3>(item, kMaxAcceleration, counters);  // over a second at most
      break;
    case kDeltaRotation:
      result.delta_rotation = unit_quaternion(item, counters);
      break;
    case kQuaternion:
      result.orientation = unit_quaternion(item, counters);
      break;
    case kEulerAngles:
      if (!result.orientation) result.orientation = quaternion_of_euler(item, counters);
      break;
    case kTemperature:
      if (const auto t = numbers<1>(item, 1000.0, counters)) result.temperature = (*t)[0];
      break;
    case kStatusByte:
      if (!result.status) result.status = integer<std::uint8_t>(item, counters);
      break;
    case kStatusWord:
      result.status = integer<std::uint32_t>(item, counters);
      break;
    default:
      counters.add("skipped.items");
  }
}

}  // namespace

MtData2 decode_mtdata2(std::span<const std::uint8_t> payload, Counters& counters) {
  constexpr std::size_t kHeader = 3;
  MtData2 result;
  while (!payload.empty()) {
    if (payload.size() < kHeader || payload.size() - kHeader < payload[2]) {
      counters.add("refused.truncated");
      result.truncated = true;
      break;
    }
    decode_item({read_big_endian<std::uint16_t>(payload), payload.subspan(kHeader, payload[2])}, result, counters);
    payload = payload.subspan(kHeader + payload[2]);
  }
  return result;
}

}  // namespace curbstone::imu::xsens
