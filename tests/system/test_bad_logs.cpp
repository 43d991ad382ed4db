#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <curbstone/imu_t.hpp>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "common/log/log_writer.hpp"
#include "tests/system/run_program.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::system_test {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kStart = 1'700'000'000'000'000;

class BadLogs : public ::testing::Test {
 protected:
  /// A log of IMU messages each 10 ms, in which the one in the middle has this time.
  void write(int count, std::int64_t middle) {
    LogWriter log(log_);
    for (int i = 0; i < count; ++i) {
      imu_t message{};
      message.utime = i == count / 2 ? middle : kStart + i * 10'000;
      std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
      message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
      log.write("IMU", bytes.data(), static_cast<int>(bytes.size()));
    }
  }
  [[nodiscard]] ProgramResult replay() const {
    return run_program("curbstone replay " + log_ + " --map " + (folder_ / "map.db").string(), 60);
  }

  testing::TemporaryFolder folder_;
  std::string log_ = folder_ / "drive.lcmlog";
};

TEST_F(BadLogs, AMessageOfAnImpossibleTimeIsCountedAndLeftOut) {
  for (const std::int64_t utime : {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min(),
                                   std::int64_t{0}, std::int64_t{-5}}) {
    std::filesystem::remove(log_);
    write(300, utime);
    const ProgramResult result = replay();
    EXPECT_EQ(result.exit_status, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("refused.time 1")) << utime;
  }
}

TEST_F(BadLogs, ALeapOfYearsEndsAndTheRestIsRead) {
  write(300, kStart + 1'000'000'000'000'000);
  const ProgramResult result = replay();
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("300 messages"));
}

TEST_F(BadLogs, DamageInTheMiddleIsSaidAndTheExitStatusIsNotZero) {
  write(3000, kStart);
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(log_));
  {
    std::fstream file(log_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(size / 2);
    file << std::string(64, 'x');
  }
  const ProgramResult result = replay();
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.err, HasSubstr("is damaged at byte"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "map.db")) << "what could be read is kept";
}

TEST_F(BadLogs, ALogThatWasCutOffIsReadToItsEnd) {
  write(300, kStart + 150 * 10'000);
  std::filesystem::resize_file(log_, std::filesystem::file_size(log_) - 7);
  const ProgramResult result = replay();
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("cut off"));
}

}  // namespace
}  // namespace curbstone::system_test
