#include "tools/bench/drivers/drivers_bench.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/temporary_folder.hpp"
#include "tools/bench/drivers/driver_rates.hpp"
#include "tools/command/run_subcommand.hpp"

namespace curbstone::bench::drivers {
namespace {

TEST(EmulatedPackets, ComeAtTheDevicesPaceAndGivePoints) {
  const LidarPackets packets = emulated_packets(lidar::models::ModelName::kRs16, 0.2);
  EXPECT_NEAR(packets.pace(), 750.75, 1);
  const LidarRate rate = measure(packets, {.rounds = 1, .min_time = 0.001});
  EXPECT_NEAR(rate.points_a_packet, 0.85 * 384, 5);
  EXPECT_GT(rate.decode_per_s, 0);
}

TEST(EncoderStream, HasAPositionEach10Ms) {
  const auto stream = encoder_stream(5);
  const auto positions = std::ranges::count_if(stream, [](const TimedFrame& frame) { return frame.frame.id == 0x181; });
  EXPECT_NEAR(static_cast<double>(positions), 490, 15);
}

TEST(BenchDrivers, WritesTheFiguresOfEachDevice) {
  test::TemporaryFolder folder;
  const std::string json = folder / "figures.json";
  std::vector<std::string> words = {"drivers",    "--seconds", "0.2",    "--rounds", "1",
                                    "--min-time", "0.001",     "--json", json};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  ASSERT_EQ(
      command::run_subcommand("bench drivers", run_bench_drivers, static_cast<int>(arguments.size()), arguments.data()),
      0);
  const auto figures = nlohmann::json::parse(std::ifstream(json));
  for (const char* name : {"rs16", "vlp16", "helios16p", "helios32"})
    EXPECT_GT(figures["lidar"][name]["decode_times_real"], 1) << name;
  for (const char* name : {"xsens", "witmotion", "zlac8015d"})
    EXPECT_GT(figures["streams"][name]["driver_times_real"], 1) << name;
}

TEST(BenchDrivers, SaysWhatIsWrongWithACapture) {
  std::vector<std::string> words = {"drivers", "--seconds", "0.2", "--rounds", "1", "--capture", "/nowhere.pcap"};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  EXPECT_EQ(
      command::run_subcommand("bench drivers", run_bench_drivers, static_cast<int>(arguments.size()), arguments.data()),
      1);
}

}  // namespace
}  // namespace curbstone::bench::drivers
