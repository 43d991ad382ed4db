#include "services/viewer/web/web_server.hpp"

#include <gmock/gmock.h>
#include <zlib.h>

#include <thread>

#include "tests/services/viewer/web/raw_client.hpp"

namespace curbstone::viewer::web {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::Gt;
using ::testing::HasSubstr;
using ::testing::Lt;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;

/// Raw deflate, as permessage-deflate wants it (RFC 7692 7.2.1).
std::string deflated(const std::string& text) {
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, text.size()) + 16, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_SYNC_FLUSH);
  out.resize(stream.total_out - 4);
  deflateEnd(&stream);
  return out;
}

std::string inflated(std::string bytes, std::size_t size) {
  bytes += std::string("\0\0\xff\xff", 4);
  z_stream stream{};
  inflateInit2(&stream, -15);
  std::string out(size + 1, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  inflate(&stream, Z_SYNC_FLUSH);
  out.resize(stream.total_out);
  inflateEnd(&stream);
  return out;
}

class WebServerTest : public ::testing::Test {
 protected:
  /// What a busy machine does not come to, unless a test is about it.
  WebServerTest() { settings_.limits.head = settings_.limits.silence = settings_.limits.write = 60s; }
  void start() {
    server_.emplace(settings_);
    host_ = "127.0.0.1:" + std::to_string(server_->port());
  }
  [[nodiscard]] RawClient connect() const { return RawClient(server_->port()); }
  std::string ask(const std::string& request) {
    RawClient client = connect();
    client.send_bytes(request);
    return client.receive_answer(!request.starts_with("HEAD "));
  }
  RawClient open_page() {
    RawClient client = connect();
    EXPECT_THAT(client.upgrade(host_, "http://" + host_), StartsWith("HTTP/1.1 101"));
    return client;
  }
  [[nodiscard]] std::int64_t counted(const std::string& name) const { return server_->counters()[name]; }
  bool comes_to(const std::function<bool()>& condition) {
    for (int i = 0; i < 1000 && !condition(); ++i) std::this_thread::sleep_for(10ms);
    return condition();
  }
  std::vector<Connections::Event> wait_for_events(std::size_t n) {
    std::vector<Connections::Event> events;
    comes_to([&] {
      for (auto& event : server_->take_events()) events.push_back(std::move(event));
      return events.size() >= n;
    });
    return events;
  }

  WebSettings settings_;
  std::optional<WebServer> server_;
  std::string host_;
};

TEST_F(WebServerTest, ServesThePageWithAPolicyThatAllowsNothingFromElsewhere) {
  start();
  const std::string answer = ask(get("/", host_));
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK"));
  EXPECT_THAT(answer, HasSubstr("Content-Security-Policy: default-src 'none'; script-src 'self'"));
  EXPECT_THAT(answer, HasSubstr("frame-ancestors 'none'"));
  EXPECT_THAT(answer, HasSubstr("X-Content-Type-Options: nosniff"));
  EXPECT_THAT(answer, HasSubstr("text/html; charset=utf-8"));
  EXPECT_THAT(answer, HasSubstr("</html>"));
  EXPECT_THAT(ask(get("/page.js?v=1", host_)), HasSubstr("text/javascript"));
}

TEST_F(WebServerTest, AnswersAHeadWithoutTheFile) {
  start();
  const std::string answer = ask(get("/", host_, "HEAD"));
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK"));
  EXPECT_THAT(answer, Not(HasSubstr("<html")));
  EXPECT_THAT(answer, Not(HasSubstr("Content-Length: 0")));
}

TEST_F(WebServerTest, RefusesANameThatIsNotItsOwn) {
  settings_.names = {"robot.local"};
  start();
  EXPECT_THAT(ask(get("/", "evil.example")), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(ask("GET / HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(ask("GET / HTTP/1.1\r\nHost: " + host_ + "\r\nHost: evil.example\r\n\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_EQ(counted("refused.host"), 3);
  EXPECT_THAT(ask(get("/", "robot.local:1234")), StartsWith("HTTP/1.1 200"));
  RawClient rebound = connect();
  EXPECT_THAT(rebound.upgrade("evil.example", "http://evil.example"), StartsWith("HTTP/1.1 403"));
  EXPECT_EQ(counted("refused.host"), 4);
}

TEST_F(WebServerTest, OnlyItsOwnPageMayWatch) {
  start();
  for (const char* origin : {"", "null", "http://evil.example", "http://localhost:1"}) {
    RawClient client = connect();
    EXPECT_THAT(client.upgrade(host_, origin), StartsWith("HTTP/1.1 403")) << origin;
  }
  EXPECT_EQ(counted("refused.origin"), 4);
  RawClient elsewhere = connect();
  EXPECT_THAT(elsewhere.upgrade(host_, "http://" + host_, "/other"), StartsWith("HTTP/1.1 404"));
  open_page();
}

TEST_F(WebServerTest, IsReadOnly) {
  start();
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE"})
    EXPECT_THAT(ask(get("/", host_, method)), StartsWith("HTTP/1.1 405")) << method;
  for (const char* target : {"/ugv.yaml", "/../etc/passwd", "/page.js/..", "http://evil.example/", "*"})
    EXPECT_THAT(ask(get(target, host_)), StartsWith("HTTP/1.1 404")) << target;
  EXPECT_EQ(counted("refused.request"), 11);
  EXPECT_THAT(ask("POST / HTTP/1.1\r\nHost: " + host_ + "\r\nContent-Length: 1000000\r\n\r\nxxxx"),
              Not(HasSubstr("200")));
}

TEST_F(WebServerTest, TellsTheNodeWhatPagesSayAndSendsThemFrames) {
  start();
  RawClient page = open_page();
  page.send_message("hello");
  auto events = wait_for_events(2);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].kind, Connections::Event::Kind::kConnected);
  EXPECT_EQ(events[1].text, "hello");
  EXPECT_EQ(events[0].page, events[1].page);
  server_->send(events[0].page, std::make_shared<std::vector<std::uint8_t>>(std::vector<std::uint8_t>{1, 2, 3}));
  EXPECT_EQ(page.receive_frame(), std::string("\x82\x03\x01\x02\x03"));
  server_->send(12345, std::make_shared<std::vector<std::uint8_t>>(3));
  { const RawClient gone = std::move(page); }
  events = wait_for_events(1);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].kind, Connections::Event::Kind::kDisconnected);
}

TEST_F(WebServerTest, ARequestThatTricklesIsCutOff) {
  settings_.limits.head = 600ms;
  start();
  RawClient slow = connect();
  const auto begin = std::chrono::steady_clock::now();
  bool is_open = slow.send_bytes("GET / HTTP/1.1\r\nHost: ");
  while (is_open && std::chrono::steady_clock::now() - begin < 20s) {
    is_open = slow.send_bytes("x");
    std::this_thread::sleep_for(50ms);
  }
  EXPECT_FALSE(is_open);
  EXPECT_EQ(counted("refused.request"), 1);
  EXPECT_TRUE(connect().is_closed_within(20)) << "and who says nothing";
}

TEST_F(WebServerTest, AHeadHasAnEnd) {
  start();
  RawClient client = connect();
  client.send_bytes("GET / HTTP/1.1\r\nHost: " + host_ + "\r\n");
  for (int i = 0; i < 100; ++i) client.send_bytes("X-Long: " + std::string(1000, 'x') + "\r\n");
  EXPECT_TRUE(client.is_closed_within(20));
  EXPECT_TRUE(comes_to([&] { return counted("refused.request") == 1; }));
  EXPECT_THAT(ask(get("/", host_)), StartsWith("HTTP/1.1 200"));
}

TEST_F(WebServerTest, GarbageIsRefused) {
  start();
  EXPECT_THAT(ask(std::string(2000, '\xff')), Not(HasSubstr("200 OK")));
  EXPECT_THAT(ask("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03 a TLS hello\r\n\r\n"), Not(HasSubstr("200 OK")));
  EXPECT_TRUE(comes_to([&] { return counted("refused.request") == 2; }));
}

TEST_F(WebServerTest, AGiantMessageEndsThePage) {
  start();
  RawClient page = open_page();
  page.send_message_head(std::uint64_t{1} << 40);
  page.send_bytes(std::string(5000, 'x'));
  EXPECT_TRUE(page.is_closed_within(20));
  EXPECT_TRUE(comes_to([&] { return counted("refused.messages") == 1; }));
  RawClient other = open_page();
  other.send_message(std::string(5000, 'x'));
  EXPECT_TRUE(other.is_closed_within(20));
  EXPECT_TRUE(comes_to([&] { return counted("refused.messages") == 2; }));
}

TEST_F(WebServerTest, FramesAreCompressedForABrowserThatUnpacksThem) {
  start();
  RawClient page = connect();
  EXPECT_THAT(page.upgrade(host_, "http://" + host_, "/live", "permessage-deflate; client_max_window_bits"),
              HasSubstr("permessage-deflate"));
  const auto events = wait_for_events(1);
  ASSERT_EQ(events.size(), 1U);
  const auto frame = std::make_shared<std::vector<std::uint8_t>>(20'000);
  for (std::size_t i = 0; i < frame->size(); ++i) (*frame)[i] = static_cast<std::uint8_t>(i / 100);
  for (int i = 0; i < 2; ++i) {  // the second does not build on the first
    server_->send(events[0].page, frame);
    const std::string heard = page.receive_frame();
    ASSERT_THAT(heard, SizeIs(AllOf(Gt(4U), Lt(2000U))));
    EXPECT_EQ(heard[0], '\xc2');  // one piece, compressed, binary
    const std::size_t head = heard[1] == 126 ? 4 : 2;
    EXPECT_EQ(inflated(heard.substr(head), frame->size()), std::string(frame->begin(), frame->end()));
  }
  page.send_compressed(deflated("a word"));
  EXPECT_EQ(wait_for_events(1)[0].text, "a word");
}

TEST_F(WebServerTest, AMessageThatUnpacksToAGiantEndsThePage) {
  start();
  RawClient page = connect();
  page.upgrade(host_, "http://" + host_, "/live", "permessage-deflate");
  const std::string bomb = deflated(std::string(3'000'000, 'x'));
  ASSERT_THAT(bomb, SizeIs(Lt(4000U)));
  page.send_compressed(bomb);
  EXPECT_TRUE(page.is_closed_within(20));
  EXPECT_TRUE(comes_to([&] { return counted("refused.messages") == 1; }));
}

TEST_F(WebServerTest, AFloodOfMessagesEndsThePage) {
  start();
  RawClient page = open_page();
  for (int i = 0; i < 1000; ++i) page.send_message("x");
  EXPECT_TRUE(page.is_closed_within(20));
  EXPECT_GE(counted("refused.messages"), 1);
  EXPECT_LE(wait_for_events(52).size(), 53U);
}

TEST_F(WebServerTest, APageThatDoesNotReadIsCutOffAndHoldsNobodyUp) {
  settings_.limits.write = 600ms;
  start();
  RawClient slow = open_page();
  slow.shrink_receive_buffer();
  RawClient other = open_page();
  const auto events = wait_for_events(2);
  ASSERT_EQ(events.size(), 2U);
  const auto frame = std::make_shared<std::vector<std::uint8_t>>(4'000'000);
  for (int i = 0; i < 20; ++i) server_->send(events[0].page, frame);
  server_->send(events[1].page, std::make_shared<std::vector<std::uint8_t>>(2));
  EXPECT_EQ(other.receive_frame().size(), 4U);
  EXPECT_TRUE(comes_to([&] { return counted("dropped.slow_page") == 1; }));
  EXPECT_GT(counted("dropped.frames"), 0);
}

TEST_F(WebServerTest, APageThatIsGoneWithoutAWordIsNoticed) {
  settings_.limits.silence = 1500ms;
  start();
  const RawClient page = open_page();  // it answers no ping
  const auto events = wait_for_events(2);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[1].kind, Connections::Event::Kind::kDisconnected);
}

TEST_F(WebServerTest, SoManyPagesMayWatchAndNoMore) {
  settings_.limits.pages = 3;
  start();
  std::vector<RawClient> pages;
  for (int i = 0; i < 3; ++i) pages.push_back(open_page());
  EXPECT_THAT(connect().upgrade(host_, "http://" + host_), StartsWith("HTTP/1.1 503"));
  EXPECT_EQ(counted("refused.pages"), 1);
  EXPECT_THAT(ask(get("/live", host_)), StartsWith("HTTP/1.1 503")) << "for the page, which is not told why";
  pages.pop_back();
  EXPECT_TRUE(comes_to(
      [&] { return RawClient(connect()).upgrade(host_, "http://" + host_).find(" 101 ") != std::string::npos; }));
  EXPECT_TRUE(comes_to([&] { return ask(get("/live", host_)).starts_with("HTTP/1.1 426"); }));
}

TEST_F(WebServerTest, TwoHundredConnectionsLeaveThePageItsOwn) {
  settings_.limits.head = 5s;
  start();
  RawClient page = open_page();
  const auto came = wait_for_events(1);
  std::vector<RawClient> crowd;
  for (int i = 0; i < 200; ++i) crowd.push_back(connect());
  EXPECT_TRUE(comes_to([&] { return counted("refused.connections") >= 150; })) << counted("refused.connections");
  page.send_message("still here");
  const auto events = wait_for_events(1);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].text, "still here");
  crowd.clear();
  EXPECT_TRUE(comes_to([&] { return ask(get("/", host_)).find("200 OK") != std::string::npos; }));
}

}  // namespace
}  // namespace curbstone::viewer::web
