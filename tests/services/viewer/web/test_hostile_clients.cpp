#include <gmock/gmock.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <thread>

#include "services/viewer/web/web_server.hpp"
#include "tests/services/viewer/web/raw_client.hpp"

namespace curbstone::viewer::web {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A page that watches, and at the same time somebody who means harm. What counts: the page gets its frames, the
/// counters tell, and afterwards the next visitor is served.
class HostileClients : public ::testing::Test {
 protected:
  HostileClients() {
    rlimit files{};  // a thousand connections are a thousand descriptors here
    getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur = std::min<rlim_t>(files.rlim_max, 8192);
    setrlimit(RLIMIT_NOFILE, &files);
  }
  /// `head`: until an unfinished request is cut off.
  void start(std::chrono::seconds head) {
    settings_.limits.head = head;
    settings_.limits.silence = 60s;
    server_.emplace(settings_);
    host_ = "127.0.0.1:" + std::to_string(server_->port());
    page_.emplace(server_->port());
    EXPECT_THAT(page_->upgrade(host_, "http://" + host_), StartsWith("HTTP/1.1 101"));
    comes_to([&] {
      for (const auto& event : server_->take_events()) id_ = event.page;
      return id_ != 0;
    });
  }
  bool comes_to(const std::function<bool()>& condition) {
    for (int i = 0; i < 2000 && !condition(); ++i) std::this_thread::sleep_for(10ms);
    return condition();
  }
  [[nodiscard]] std::int64_t counted(const std::string& name) const { return server_->counters()[name]; }
  /// Sends frames one by one until each has come.
  void expect_frames(int n) {
    for (int i = 0; i < n; ++i) {
      server_->send(id_, std::make_shared<std::vector<std::uint8_t>>(100, static_cast<std::uint8_t>(i)));
      const std::string heard = page_->receive_frame();
      ASSERT_EQ(heard.size(), 102U) << "frame " << i;
      EXPECT_EQ(heard.back(), static_cast<char>(i));
    }
  }
  void expect_service() {
    EXPECT_TRUE(comes_to([&] {
      RawClient visitor(server_->port());
      visitor.send_bytes(get("/", host_));
      return visitor.receive_answer().find("200 OK") != std::string::npos;
    }));
  }

  WebSettings settings_;
  std::optional<WebServer> server_;
  std::string host_;
  std::optional<RawClient> page_;
  PageId id_ = 0;
};

TEST_F(HostileClients, AThousandConnectionsAtATime) {
  start(60s);
  std::vector<RawClient> crowd;
  for (int i = 0; i < 1000; ++i) crowd.emplace_back(server_->port());
  expect_frames(5);
  EXPECT_TRUE(comes_to([&] { return counted("refused.connections") >= 900; })) << counted("refused.connections");
  crowd.clear();
  expect_service();
}

TEST_F(HostileClients, RequestsThatTrickleOnEveryConnectionThereIs) {
  start(2s);
  std::atomic<bool> stop = false;
  std::thread slowloris([&] {
    std::vector<RawClient> crowd;
    for (int i = 0; i < 60; ++i) crowd.emplace_back(server_->port());
    for (auto& client : crowd) client.send_bytes("GET / HTTP/1.1\r\nHost: " + host_ + "\r\nX: ");
    while (!stop) {
      for (auto& client : crowd) client.send_bytes("x");
      std::this_thread::sleep_for(50ms);
    }
  });
  EXPECT_TRUE(comes_to([&] { return counted("refused.connections") > 0; }));
  expect_frames(5);
  EXPECT_TRUE(comes_to([&] { return counted("refused.request") >= 40; })) << counted("refused.request");
  expect_service();  // though they go on trickling: their time was up
  stop = true;
  slowloris.join();
  expect_frames(2);
}

TEST_F(HostileClients, GiantFramesOneAfterAnother) {
  start(2s);
  for (int i = 0; i < 30; ++i) {
    RawClient giant(server_->port());
    ASSERT_THAT(giant.upgrade(host_, "http://" + host_), StartsWith("HTTP/1.1 101")) << i;
    giant.send_message_head(std::uint64_t{1} << (20 + i));
    giant.send_bytes(std::string(20'000, 'x'));
    EXPECT_TRUE(giant.is_closed_within(20)) << i;
  }
  EXPECT_TRUE(comes_to([&] { return counted("refused.messages") == 30; })) << counted("refused.messages");
  expect_frames(5);
  expect_service();
}

TEST_F(HostileClients, NamesThatWereBoundToThisAddress) {
  start(2s);
  const std::vector<std::string> names = {"evil.example",
                                          "127.0.0.1.evil.example",
                                          "localhost.evil.example",
                                          "evil.example:8088",
                                          "127.0.0.1@evil.example",
                                          "0x7f000001",
                                          "2130706433",
                                          "127.1",
                                          "[::ffff:127.0.0.1]",
                                          "127.0.0.1:80:80",
                                          "localhost."};
  for (const std::string& name : names) {
    RawClient visitor(server_->port());
    visitor.send_bytes(get("/", name));
    EXPECT_THAT(visitor.receive_answer(), HasSubstr(" 403 ")) << name;
    RawClient rebound(server_->port());
    EXPECT_THAT(rebound.upgrade(name, "http://" + name), HasSubstr(" 403 ")) << name;
  }
  EXPECT_EQ(counted("refused.host"), 2 * static_cast<std::int64_t>(names.size()));
  expect_frames(5);
}

}  // namespace
}  // namespace curbstone::viewer::web
