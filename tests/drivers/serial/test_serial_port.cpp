#include "drivers/serial/serial_port.hpp"

#include <gmock/gmock.h>

#include <array>
#include <stdexcept>

#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/pty.hpp"
#include "tests/paths.hpp"

namespace curbstone::serial {
namespace {

using test::Bytes;
using test::Pty;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string error_of(const SerialSettings& settings) {
  try {
    const SerialPort port(settings);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(SerialPortTest, EveryByteGoesThroughUnchangedBothWays) {
  const test::Pty pty;
  SerialPort port({pty.path(), 921600});
  test::Bytes all(256);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i);
  EXPECT_EQ(port.write(all), all.size());
  EXPECT_EQ(pty.wait_and_read(), all);
  pty.write(all);
  pollfd wait{port.fd(), POLLIN, 0};
  ASSERT_EQ(poll(&wait, 1, 1000), 1);
  test::Bytes buffer(1000);
  const auto read = port.read(buffer);
  ASSERT_EQ(read.status, SerialPort::Status::kData);
  buffer.resize(read.size);
  EXPECT_EQ(buffer, all);
}

TEST(SerialPortTest, TellsNothingYetFromGone) {
  test::Pty pty;
  SerialPort port({pty.path(), 115200});
  std::array<std::uint8_t, 16> buffer;
  EXPECT_EQ(port.read(buffer).status, SerialPort::Status::kNothing);
  pty.unplug();
  EXPECT_EQ(port.read(buffer).status, SerialPort::Status::kGone);
  EXPECT_EQ(port.write(buffer), 0u);
}

TEST(SerialPortTest, IsHeldByOneProgramAtATime) {
  const test::Pty pty;
  {
    const SerialPort port({pty.path(), 115200});
    EXPECT_THAT(error_of({pty.path(), 115200}), AllOf(HasSubstr(pty.path()), HasSubstr("another program holds it")));
  }
  EXPECT_EQ(error_of({pty.path(), 115200}), "");
}

TEST(SerialPortTest, RunsAtAnyBaudAndReadsBackWhichOneWasGranted) {
  const test::Pty pty;
  for (const int baud : {9600, 115200, 123'456, 250'000, 3'500'000}) {
    EXPECT_EQ(SerialPort({pty.path(), baud}).baud(), baud);
  }
}

TEST(SerialPortTest, APortThatRefusesLowLatencyIsUsedAllTheSame) {
  const test::Pty pty;
  EXPECT_EQ(SerialPort({pty.path(), 115200}).low_latency(), LowLatency{});
}

TEST(SerialPortTest, ErrorsSayWhatToDo) {
  EXPECT_THAT(error_of({"/dev/no_such_tty", 115200}), AllOf(HasSubstr("/dev/no_such_tty"), HasSubstr("plugged in")));
  EXPECT_THAT(error_of({test::source_path("CMakeLists.txt"), 115200}), HasSubstr("is no serial port"));
  EXPECT_THAT(error_of({"/dev/null", 115200}), HasSubstr("is no serial port"));
  EXPECT_THROW(SerialPort({"/dev/null", 115200}), NotASerialPort) << "no waiting helps";
}

}  // namespace
}  // namespace curbstone::serial
