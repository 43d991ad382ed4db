// What the viewer allows if nobody configured it, and that it starts with the vehicle and the demo.
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <regex>

#include "services/viewer/viewer_config.hpp"
#include "tests/paths.hpp"

namespace curbstone::viewer {
namespace {

using ::testing::IsEmpty;
using namespace std::chrono_literals;

TEST(ViewerDefaults, OnlyThisMachineAndOnlyThePage) {
  const ViewerConfig config;
  EXPECT_EQ(config.foxglove_port, 0) << "the door for Foxglove is closed";
  const web::WebSettings settings = web_settings(config);
  EXPECT_EQ(settings.address, "127.0.0.1");
  EXPECT_EQ(settings.port, 8088);
  EXPECT_THAT(settings.names, IsEmpty());
  EXPECT_THAT(settings.origins, IsEmpty());
  EXPECT_THAT(settings.subprotocols, IsEmpty());
  EXPECT_EQ(settings.folder, "") << "the page is the program's";
  EXPECT_EQ(page_address(config, 8088), "http://127.0.0.1:8088/");
}

TEST(ViewerDefaults, LimitsAreThoseOfTheReference) {
  const web::WebLimits limits = web_settings(ViewerConfig{}).limits;
  EXPECT_EQ(limits.pages, 8U);
  EXPECT_LE(limits.connections, 48U);
  EXPECT_LE(limits.head_bytes, 8192U);
  EXPECT_LE(limits.message_bytes, 4096U);
  EXPECT_LE(limits.messages_per_second, 50U);
  EXPECT_LE(limits.head, 5s);
  EXPECT_LE(limits.silence, 20s);
  EXPECT_LE(limits.write, 10s);
}

TEST(ViewerDefaults, StartsWithTheVehicleAndWithTheDemo) {
  for (const char* file : {"procman/ugv.cfg", "procman/demo.cfg"}) {
    std::ifstream in(test::source_path(file));
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const std::regex command("\n  cmd \"viewer\" \\{\\s+exec = \"[^\"]*curbstone-viewer [^\"]*--config ");
    EXPECT_TRUE(std::regex_search(text, command)) << file;
  }
}

}  // namespace
}  // namespace curbstone::viewer
