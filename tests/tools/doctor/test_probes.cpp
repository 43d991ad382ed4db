// On the network of this test's own namespace (scripts/isolated), and with things broken in it.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

#include "tools/doctor/doctor.hpp"
#include "tools/doctor/facts/bus_facts.hpp"
#include "tools/doctor/facts/bus_probe.hpp"
#include "tools/doctor/facts/lidar_facts.hpp"

namespace curbstone::doctor {
namespace {

using ::testing::HasSubstr;

BusAddress test_bus() {
  return parse_bus_url(facts::bus_url(std::getenv("CURBSTONE_TEST_URL"))).value();
}

/// Sends datagrams to an address until it is destroyed.
class Chatter {
 public:
  Chatter(const char* address, int port) : thread_([this, address, port] { send(address, port); }) {}
  ~Chatter() {
    stop_ = true;
    thread_.join();
  }
  Chatter(const Chatter&) = delete;
  Chatter& operator=(const Chatter&) = delete;

 private:
  void send(const char* address, int port) {
    const int fd = socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    inet_pton(AF_INET, address, &to.sin_addr);
    const std::string bytes("LC02\0\0\0\0CHATTER\0x", 17);
    while (!stop_) {
      sendto(fd, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
      usleep(2000);
    }
    close(fd);
  }
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

TEST(BusProbe, HearsItselfAndTheOthersOnTheBus) {
  const Chatter chatter("239.255.76.67", test_bus().port);
  const auto probe = facts::probe_bus(test_bus(), 1.0, "");
  EXPECT_EQ(probe.error, "");
  ASSERT_TRUE(probe.round_trip);
  EXPECT_LT(*probe.round_trip, 1'000'000);
  EXPECT_GT(probe.messages.at("CHATTER"), 0);
  EXPECT_EQ(probe.bytes, 17 * probe.messages.at("CHATTER"));
  EXPECT_TRUE(probe.other_groups.empty());
  EXPECT_EQ(facts::probe_bus(test_bus(), 0.3, "CHATTER").bytes, 0) << "what is not recorded takes no disk";
}

TEST(BusProbe, SeesAnotherBusOnThePort) {
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);  // who is in that group brings it to this host
  ip_mreq membership{};
  inet_pton(AF_INET, "239.255.76.99", &membership.imr_multiaddr);
  ASSERT_EQ(setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership), 0);
  const Chatter chatter("239.255.76.99", test_bus().port);
  const auto probe = facts::probe_bus(test_bus(), 1.0, "");
  EXPECT_GT(probe.other_groups.at("239.255.76.99"), 0);
  EXPECT_TRUE(probe.messages.empty());
  close(fd);
}

TEST(BusProbe, SeesThatTheKernelGivesLessThanIsAskedFor) {
  BusAddress greedy = test_bus();
  greedy.buffer = 1 << 30;  // more than any net.core.rmem_max
  const auto probe = facts::probe_bus(greedy, 0.1, "");
  EXPECT_GT(probe.granted_buffer, 0);
  EXPECT_LT(probe.granted_buffer, greedy.buffer);
}

TEST(LidarProbe, CountsPacketsThatADriverHasToo) {
  const int driver = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in any{};
  any.sin_family = AF_INET;
  any.sin_port = htons(16699);
  ASSERT_EQ(bind(driver, reinterpret_cast<sockaddr*>(&any), sizeof any), 0);
  const Chatter chatter("127.0.0.1", 16699);
  const auto lidar = facts::probe_lidar(16699, 0.5);
  EXPECT_TRUE(lidar.listened);
  EXPECT_GT(lidar.packets.at("127.0.0.1"), 0);
  std::int64_t driven = 0;
  for (char byte = 0; recv(driver, &byte, 1, MSG_DONTWAIT) >= 0;) ++driven;
  EXPECT_GE(driven, lidar.packets.at("127.0.0.1")) << "none was stolen";
  close(driver);
}

nlohmann::json doctor_says(int& status) {
  std::vector<std::string> words = {"doctor",   "--json",     "--seconds", "0.2",
                                    "--config", "/none.yaml", "--procman", "/none.cfg"};
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  ::testing::internal::CaptureStdout();
  status = run_doctor(static_cast<int>(argv.size()), argv.data());
  return nlohmann::json::parse(::testing::internal::GetCapturedStdout());
}

std::string kind_of(const nlohmann::json& report, const std::string& check) {
  for (const auto& verdict : report["checks"]) {
    if (verdict["check"] == check) return verdict["kind"];
  }
  return "not there";
}

TEST(Doctor, FindsAMissingRouteAndFilesOnARealHost) {
  int status = 0;
  const auto before = doctor_says(status);
  EXPECT_EQ(kind_of(before, "route"), "good");
  EXPECT_EQ(kind_of(before, "round trip"), "good");
  EXPECT_EQ(kind_of(before, "config"), "finding") << "there is no /none.yaml";
  ASSERT_EQ(std::system("ip route del 224.0.0.0/4 dev lo"), 0);
  const auto after = doctor_says(status);
  EXPECT_EQ(status, 1);
  EXPECT_EQ(kind_of(after, "route"), "finding");
  EXPECT_EQ(kind_of(after, "round trip"), "finding");
  ASSERT_EQ(std::system("ip route add 224.0.0.0/4 dev lo"), 0);
}

TEST(Doctor, WrongUsageIsTwo) {
  std::vector<std::string> words = {"doctor", "--bogus"};
  std::vector<char*> argv = {words[0].data(), words[1].data()};
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run_doctor(2, argv.data()), 2);
  ::testing::internal::GetCapturedStderr();
}

}  // namespace
}  // namespace curbstone::doctor
