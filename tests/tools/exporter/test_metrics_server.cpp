#include "tools/exporter/metrics_server.hpp"

#include <gtest/gtest.h>
#include <httplib.h>

namespace curbstone::exporter {
namespace {

TEST(MetricsServer, AnswersForMetricsOnly) {
  const MetricsServer server({}, [] { return "a{} 1\n"; });
  httplib::Client client("127.0.0.1", server.port());
  const auto metrics = client.Get("/metrics");
  ASSERT_TRUE(metrics);
  EXPECT_EQ(metrics->status, 200);
  EXPECT_EQ(metrics->body, "a{} 1\n");
  EXPECT_EQ(metrics->get_header_value("Content-Type"), "text/plain; version=0.0.4; charset=utf-8");
  EXPECT_EQ(client.Get("/")->status, 404);
  EXPECT_EQ(client.Post("/metrics")->status, 404);
}

TEST(MetricsServer, AnswersOnlyToItsOwnNames) {
  const MetricsServer server({}, [] { return ""; });
  httplib::Client client("127.0.0.1", server.port());
  EXPECT_EQ(client.Get("/metrics", {{"Host", "evil.example"}})->status, 403);
  EXPECT_EQ(client.Get("/metrics", {{"Host", ""}})->status, 403);
  EXPECT_EQ(client.Get("/metrics", {{"Host", "localhost:" + std::to_string(server.port())}})->status, 200);
}

TEST(MetricsServer, APortThatAnotherServerHasIsAnError) {
  const MetricsServer first({}, [] { return ""; });
  EXPECT_THROW(MetricsServer({"127.0.0.1", first.port(), {}}, [] { return ""; }), std::runtime_error);
}

TEST(MetricsServer, AnAddressThatIsNotOfThisHostIsAnError) {
  EXPECT_THROW(MetricsServer({"192.0.2.1", 9750, {}}, [] { return ""; }), std::runtime_error);
}

}  // namespace
}  // namespace curbstone::exporter
