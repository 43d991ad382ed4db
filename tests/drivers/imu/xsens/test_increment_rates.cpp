// Increments whose rate is another than that of the samples: each is the integral over its own interval.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "common/bytes/big_endian.hpp"
#include "drivers/imu/xsens/xsens_device.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/stamps.hpp"

namespace curbstone::imu::xsens {
namespace {

/// Every how many messages of 400 Hz an item comes; 0: never.
struct Rates {
  const char* name;
  int acceleration, rate_of_turn, delta_v, delta_q;
  int samples;  // of 400 messages that can be used
};

class IncrementRates : public ::testing::TestWithParam<Rates> {
 protected:
  /// Message `n` of a device that turns and accelerates evenly.
  [[nodiscard]] static test::Bytes message(int n) {
    test::Bytes payload;
    const auto item = [&](std::uint16_t id, std::initializer_list<double> numbers) {
      append_big_endian(payload, id);
      payload.push_back(static_cast<std::uint8_t>(8 * numbers.size()));
      for (const double number : numbers) append_big_endian(payload, std::bit_cast<std::uint64_t>(number));
    };
    const auto is_due = [n](int each) { return each > 0 && n % each == 0; };
    append_big_endian(payload, std::uint16_t{0x1020});
    payload.push_back(2);
    append_big_endian(payload, static_cast<std::uint16_t>(n));
    append_big_endian(payload, std::uint16_t{0x1060});
    payload.push_back(4);
    append_big_endian(payload, static_cast<std::uint32_t>(25 * n));
    const Rates& rates = GetParam();
    if (is_due(rates.acceleration)) item(0x4023, {0.5, -1.5, 9.8});
    if (is_due(rates.delta_v)) {
      const double time = rates.delta_v / 400.0;
      item(0x4013, {0.5 * time, -1.5 * time, 9.8 * time});
    }
    if (is_due(rates.rate_of_turn)) item(0x8023, {0, 0, 0.8});
    if (is_due(rates.delta_q)) {
      const double turn = 0.8 * rates.delta_q / 400.0;
      item(0x8033, {std::cos(turn / 2), 0, 0, std::sin(turn / 2)});
    }
    return encode_xbus(Mid::kMtData2, payload);
  }
};

TEST_P(IncrementRates, GiveNoWrongNumber) {
  XsensDevice device({.configure = false}, [](auto) {});
  int samples = 0;
  for (int n = 0; n < 400; ++n) {
    if (n > 100 && n % 97 == 0) continue;  // lost
    device.on_bytes(test::kStart + 2'500 * n, message(n), [&](const device::ImuSample& sample) {
      ++samples;
      EXPECT_NEAR(sample.acceleration[1], -1.5, 1e-3) << n;
      EXPECT_NEAR(sample.acceleration[2], 9.8, 1e-3) << n;
      EXPECT_NEAR(sample.angular_rate[2], 0.8, 1e-3) << n;
    });
  }
  EXPECT_GE(samples, GetParam().samples - 8);
}
INSTANTIATE_TEST_SUITE_P(Items, IncrementRates,
                         ::testing::Values(Rates{"RarerThanSamples", 1, 1, 4, 4, 400},
                                           Rates{"HalfAsOften", 1, 1, 2, 2, 400},
                                           Rates{"VelocityRarerThanRotation", 0, 0, 4, 1, 100},
                                           Rates{"RotationRarerThanVelocity", 0, 0, 1, 4, 100},
                                           Rates{"RotationOftenerThanSamples", 4, 4, 4, 1, 100},
                                           Rates{"Alike", 4, 4, 4, 4, 100},
                                           Rates{"AccelerationBesideRotation", 4, 1, 4, 1, 100}),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace curbstone::imu::xsens
