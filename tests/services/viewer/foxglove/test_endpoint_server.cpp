#include <gmock/gmock.h>

#include <thread>

#include "services/viewer/foxglove/wire.hpp"
#include "services/viewer/viewer_config.hpp"
#include "services/viewer/web/web_server.hpp"
#include "tests/services/viewer/web/raw_client.hpp"

namespace curbstone::viewer::web {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// The server that the endpoint stands behind, as the configuration makes it.
class DoorServer : public ::testing::Test {
 protected:
  DoorServer() {
    settings_ = endpoint_settings(ViewerConfig{});
    settings_.limits.write = 600ms;
  }
  void start() {
    server_.emplace(settings_);
    host_ = "127.0.0.1:" + std::to_string(server_->port());
  }
  [[nodiscard]] std::string request(const std::string& subprotocols, const std::string& more = "",
                                    const std::string& host = "") const {
    return "GET / HTTP/1.1\r\nHost: " + (host.empty() ? host_ : host) +
           "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
           "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
           (subprotocols.empty() ? "" : "Sec-WebSocket-Protocol: " + subprotocols + "\r\n") + more + "\r\n";
  }
  std::string answer(const std::string& asked) {
    RawClient client(server_->port());
    client.send_bytes(asked);
    return receive_until(client, "\r\n\r\n");
  }
  /// What comes until `end` is in it; on a busy machine that takes its time.
  static std::string receive_until(RawClient& client, std::string_view end) {
    std::string heard;
    for (int i = 0; i < 100 && heard.find(end) == std::string::npos; ++i) heard += client.receive(100);
    return heard;
  }
  bool comes_to(const std::function<bool()>& condition) {
    for (int i = 0; i < 1000 && !condition(); ++i) std::this_thread::sleep_for(10ms);
    return condition();
  }
  /// The id of the client that came.
  PageId came() {
    PageId id = 0;
    comes_to([&] {
      for (const auto& event : server_->take_events())
        if (event.kind == Connections::Event::Kind::kConnected) id = event.page;
      return id != 0;
    });
    return id;
  }
  [[nodiscard]] std::int64_t counted(const std::string& name) const { return server_->counters()[name]; }

  WebSettings settings_;
  std::optional<WebServer> server_;
  std::string host_;
};

TEST_F(DoorServer, AgreesToTheFirstSubprotocolThatItKnows) {
  start();
  EXPECT_THAT(answer(request("foxglove.websocket.v1")),
              AllOf(StartsWith("HTTP/1.1 101"), HasSubstr("Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n")));
  EXPECT_THAT(answer(request("foxglove.sdk.v1")), HasSubstr("Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n"));
  EXPECT_THAT(answer(request("chat, foxglove.sdk.v1, foxglove.websocket.v1")),
              HasSubstr("Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n"));
}

TEST_F(DoorServer, RefusesWhoSpeaksNoneOfThem) {
  start();
  EXPECT_THAT(answer(request("")), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(answer(request("foxglove.websocket.v2")), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(answer(request("\"")), StartsWith("HTTP/1.1 400"));
  EXPECT_EQ(counted("refused.request"), 3);
}

TEST_F(DoorServer, LetsPagesOfTheListInAndNoOthers) {
  start();
  EXPECT_THAT(answer(request("foxglove.sdk.v1", "Origin: https://app.foxglove.dev\r\n")), StartsWith("HTTP/1.1 101"));
  EXPECT_THAT(answer(request("foxglove.sdk.v1", "Origin: http://evil.example\r\n")), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(answer(request("foxglove.sdk.v1", "Origin: null\r\n")), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(answer(request("foxglove.sdk.v1", "Origin: http://" + host_ + "\r\n")), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(
      answer(request("foxglove.sdk.v1", "Origin: https://app.foxglove.dev\r\nOrigin: https://app.foxglove.dev\r\n")),
      StartsWith("HTTP/1.1 403"));
  EXPECT_EQ(counted("refused.origin"), 4);
}

TEST_F(DoorServer, RefusesANameThatIsNotItsOwn) {
  start();
  EXPECT_THAT(answer(request("foxglove.sdk.v1", "", "evil.example:8765")), StartsWith("HTTP/1.1 403"));
  EXPECT_EQ(counted("refused.host"), 1);
}

TEST_F(DoorServer, ServesNoFiles) {
  start();
  EXPECT_THAT(answer(get("/", host_)), AllOf(StartsWith("HTTP/1.1 426"), Not(HasSubstr("<html"))));
}

TEST_F(DoorServer, CountsWhatAClientHasNotTakenAndEndsOneThatTakesNothing) {
  start();
  RawClient client(server_->port());
  client.shrink_receive_buffer();
  client.send_bytes(request("foxglove.sdk.v1"));
  const PageId id = came();
  ASSERT_NE(id, 0U);
  const auto large = std::make_shared<const std::vector<std::uint8_t>>(std::vector<std::uint8_t>(8'000'000));
  server_->send(id, large);
  EXPECT_GE(server_->queued(id), 8'000'000U);
  EXPECT_TRUE(comes_to([&] { return counted("dropped.slow_page") == 1; }));
  EXPECT_TRUE(comes_to([&] { return server_->queued(id) == 0; }));
  server_->send(id, large);
  EXPECT_TRUE(comes_to([&] { return server_->queued(id) == 0; })) << "it has left";
}

TEST_F(DoorServer, CountsNothingForAClientThatTakesAll) {
  start();
  RawClient client(server_->port());
  client.send_bytes(request("foxglove.sdk.v1"));
  const PageId id = came();
  ASSERT_NE(id, 0U);
  server_->send_text(id, "{}");
  EXPECT_THAT(receive_until(client, "{}"), HasSubstr("\x81\x02{}"));  // a whole text message
  server_->send(id, std::make_shared<const std::vector<std::uint8_t>>(std::vector<std::uint8_t>{7}));
  EXPECT_THAT(receive_until(client, "\x07"), HasSubstr("\x82\x01\x07"));  // a binary one
  EXPECT_TRUE(comes_to([&] { return server_->queued(id) == 0; }));
}

TEST_F(DoorServer, EndsAClientThatSaysTooMuchAtOnce) {
  start();
  RawClient client(server_->port());
  client.send_bytes(request("foxglove.sdk.v1"));
  ASSERT_NE(came(), 0U);
  client.send_message_head(1'000'000'000'000);
  client.send_bytes(std::string(20'000, 'x'));
  EXPECT_TRUE(client.is_closed_within(10));
  EXPECT_EQ(counted("refused.messages"), 1);
}

TEST_F(DoorServer, TakesNoMoreClientsThanPages) {
  settings_.limits.pages = 2;
  start();
  RawClient one(server_->port());
  RawClient two(server_->port());
  one.send_bytes(request("foxglove.sdk.v1"));
  EXPECT_THAT(receive_until(one, "\r\n\r\n"), StartsWith("HTTP/1.1 101"));
  two.send_bytes(request("foxglove.sdk.v1"));
  EXPECT_THAT(receive_until(two, "\r\n\r\n"), StartsWith("HTTP/1.1 101"));
  EXPECT_THAT(answer(request("foxglove.sdk.v1")), StartsWith("HTTP/1.1 503"));
  EXPECT_EQ(counted("refused.pages"), 1);
}

}  // namespace
}  // namespace curbstone::viewer::web
