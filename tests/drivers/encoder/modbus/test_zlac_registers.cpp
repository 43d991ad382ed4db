#include "drivers/encoder/modbus/zlac_registers.hpp"

#include <gtest/gtest.h>

namespace curbstone::encoder::modbus {
namespace {

TEST(ZlacRegisters, PositionsAreTwoInt32WithTheBigWordFirst) {
  const std::array<std::uint16_t, 4> registers = {0x0000, 0x1000, 0xFFFF, 0xF000};
  EXPECT_EQ(positions(registers), (std::array<std::int32_t, 2>{4096, -4096}));
  const std::array<std::uint16_t, 4> extremes = {0x7FFF, 0xFFFF, 0x8000, 0x0000};
  EXPECT_EQ(positions(extremes), (std::array<std::int32_t, 2>{INT32_MAX, INT32_MIN}));
}

TEST(ZlacRegisters, EitherByteOfTheStatusMayRaiseAnAlarm) {
  EXPECT_TRUE(drive_state(0x00C0).alarm);
  EXPECT_TRUE(drive_state(0xC000).alarm);
  EXPECT_FALSE(drive_state(0x4141).alarm);
  EXPECT_TRUE(drive_state(0x0080).emergency_stop);
  EXPECT_TRUE(drive_state(0x8000).emergency_stop);
}

TEST(ZlacRegisters, ADriveIsEnabledWhenBothWheelsAreHeldOrRun) {
  EXPECT_TRUE(drive_state(0x4040).enabled);
  EXPECT_TRUE(drive_state(0x0101).enabled);
  EXPECT_FALSE(drive_state(0x0000).enabled) << "released";
  EXPECT_FALSE(drive_state(0x4000).enabled) << "one of them";
  EXPECT_FALSE(drive_state(0xC141).enabled) << "in alarm";
}

}  // namespace
}  // namespace curbstone::encoder::modbus
