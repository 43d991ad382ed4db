#include "tools/simulate/devices/modbus_drive_emulator.hpp"

#include <gmock/gmock.h>

#include <vector>

namespace curbstone::simulate::devices {
namespace {

using ::testing::ElementsAreArray;
using ::testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

Bytes ask(ModbusDriveEmulator& drive, const Bytes& request) {
  return drive.on_bytes(request) ? drive.answer() : Bytes{};
}

TEST(ModbusDriveEmulator, AnswersTheWorkedExamplesOfTheManual) {
  ModbusDriveEmulator drive;
  drive.set_counts(4096, -4096);
  drive.set_speeds(1000, -1000);
  EXPECT_THAT(ask(drive, {0x01, 0x03, 0x20, 0xA7, 0x00, 0x06, 0x7F, 0xEB}),
              ElementsAreArray({0x01, 0x03, 0x0C, 0x00, 0x00, 0x10, 0x00, 0xFF, 0xFF, 0xF0, 0x00, 0x03, 0xE8, 0xFC,
                                0x18, 0x07, 0x64}));
  drive.set_speeds(100, 100);
  EXPECT_THAT(ask(drive, {0x01, 0x03, 0x20, 0xAB, 0x00, 0x02, 0xBE, 0x2B}),
              ElementsAreArray({0x01, 0x03, 0x04, 0x00, 0x64, 0x00, 0x64, 0xBA, 0x07}));
}

TEST(ModbusDriveEmulator, RefusesWhatItDoesNotKnowAndEveryWrite) {
  ModbusDriveEmulator drive;
  EXPECT_THAT(ask(drive, {0x01, 0x03, 0x20, 0xAB, 0x00, 0x20, 0x3E, 0x32}),
              ElementsAreArray({0x01, 0x83, 0x02, 0xC0, 0xF1}));
  const Bytes both_targets = {0x01, 0x06, 0x20, 0x88, 0x00, 0x64, 0x03, 0xCB};
  const Bytes refusal = ask(drive, both_targets);
  ASSERT_EQ(refusal.size(), 5u);
  EXPECT_EQ(refusal[1], 0x86);
  EXPECT_EQ(refusal[2], 1);
}

TEST(ModbusDriveEmulator, SaysNothingToOthersRequestsAndToDamagedOnesAndFindsTheNext) {
  ModbusDriveEmulator drive(7);
  EXPECT_THAT(ask(drive, {0x01, 0x03, 0x20, 0xAB, 0x00, 0x02, 0xBE, 0x2B}), IsEmpty());
  ModbusDriveEmulator other;
  EXPECT_THAT(ask(other, {0x01, 0x03, 0x20, 0xAB, 0x00, 0x02, 0xBE, 0x2C}), IsEmpty());
  EXPECT_EQ(ask(other, {0x55, 0x01, 0x03, 0x20, 0xAB, 0x00, 0x02, 0xBE, 0x2B}).size(), 9u);
}

}  // namespace
}  // namespace curbstone::simulate::devices
