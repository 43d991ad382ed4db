#pragma once

#include <gtest/gtest.h>

#include <curbstone/imu_t.hpp>
#include <curbstone/service_config_t.hpp>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "common/log/log_writer.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/command/run_subcommand.hpp"
#include "tools/log_tool/log_tool.hpp"

namespace curbstone::log_tool {

/// Writes logs, runs `curbstone log`, and reads what it wrote.
class LogToolTest : public ::testing::Test {
 protected:
  static constexpr std::int64_t kBegin = 1'795'467'120'000'000;  // 2026-11-23T20:52:00Z, us

  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }

  template <class Message>
  static void write(LogWriter& log, const std::string& channel, const Message& message, std::int64_t utime = 0) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    log.write(channel, bytes.data(), static_cast<int>(bytes.size()), utime);
  }
  /// Ten seconds of IMU at 10 Hz, with WHEELS every second that are no message of a known type.
  std::string drive(const std::string& name) const {
    LogWriter log(path(name));
    for (int i = 0; i < 100; ++i) {
      imu_t imu{};
      imu.utime = kBegin + i * 100'000;
      imu.sequence = i;
      write(log, "IMU", imu);
      if (i % 10 == 0) log.write("WHEELS", "12345678abcd", 12, imu.utime);
    }
    return path(name);
  }

  /// As a process publishes how it is configured.
  static void write_config(LogWriter& log, const std::string& section, const std::string& yaml, std::int64_t utime) {
    write(log, "CONFIG", service_config_t{utime, section, section, "ugv", "0.0.1", yaml});
  }

  int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "log");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const int status = command::run_subcommand("log", run_log, static_cast<int>(argv.size()), argv.data());
    out_ = ::testing::internal::GetCapturedStdout();
    err_ = ::testing::internal::GetCapturedStderr();
    return status;
  }
  static std::string bytes_of(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    EXPECT_TRUE(in) << file;
    return {std::istreambuf_iterator<char>(in), {}};
  }

  test::TemporaryFolder folder_;
  std::string out_;
  std::string err_;
};

}  // namespace curbstone::log_tool
