#include <gmock/gmock.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "services/viewer/web/listening_socket.hpp"
#include "services/viewer/web/web_server.hpp"

namespace curbstone::viewer::web {
namespace {

using ::testing::HasSubstr;

TEST(ListeningSocketTest, SaysWhatIsWrong) {
  const auto error_of = [](const std::string& address, std::uint16_t port, const std::string& network) -> std::string {
    try {
      (void)open_listening_socket(address, port, 1, network);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(error_of("nonsense", 0, ""), HasSubstr("'nonsense' is no address"));
  EXPECT_THAT(error_of("203.0.113.5", 0, ""), HasSubstr("203.0.113.5, port 0: Cannot assign"));
  EXPECT_THAT(error_of("127.0.0.1", 0, "/proc/none"), HasSubstr("/proc/none: not a network"));
  const int taken = open_listening_socket("127.0.0.1", 0, 1, "");
  EXPECT_THAT(error_of("127.0.0.1", port_of(taken), ""), HasSubstr("Address already in use"));
  const int elsewhere = open_listening_socket("127.0.0.1", 0, 1, "/proc/self/ns/net");
  EXPECT_GT(port_of(elsewhere), 0);
}

TEST(ListeningSocketTest, TakesTheNextFreePortWhereItMayTrySeveral) {
  const int first = open_listening_socket("127.0.0.1", 18088, 20, "");
  const int second = open_listening_socket("127.0.0.1", 18088, 20, "");
  EXPECT_EQ(port_of(first), 18088);
  EXPECT_EQ(port_of(second), 18089);
  EXPECT_THROW((void)open_listening_socket("127.0.0.1", 18088, 2, ""), std::runtime_error);
  close(first);
  close(second);
}

TEST(WaitingServer, ListensAsSoonAsItsPortIsFree) {
  const int taken = open_listening_socket("127.0.0.1", 0, 1, "");
  WebSettings settings;
  settings.port = port_of(taken);
  EXPECT_THROW(WebServer{settings}, NotFree) << "a tool's user reads why at once";
  settings.waits = true;
  const WebServer server(settings);
  EXPECT_EQ(server.port(), 0);
  EXPECT_THAT(server.fault(), HasSubstr("port " + std::to_string(settings.port) + ": Address already in use"));
  close(taken);
  for (int i = 0; i < 1000 && server.port() == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(server.port(), settings.port);
  EXPECT_EQ(server.fault(), "");
}

TEST(WaitingServer, DoesNotWaitForWhatNoWaitingMends) {
  WebSettings settings;
  settings.address = "nonsense";
  settings.waits = true;
  EXPECT_THROW(WebServer{settings}, std::invalid_argument);
}

}  // namespace
}  // namespace curbstone::viewer::web
