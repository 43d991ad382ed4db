#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "services/viewer/foxglove/topics.hpp"
#include "tests/paths.hpp"

namespace curbstone::viewer::foxglove {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::StartsWith;

std::vector<std::string> panels_in(const json& layout) {
  if (layout.is_string()) return {layout};
  std::vector<std::string> panels;
  for (const char* half : {"first", "second"}) {
    for (const std::string& panel : panels_in(layout.at(half))) panels.push_back(panel);
  }
  return panels;
}

/// config/foxglove/curbstone.json
class LayoutTest : public ::testing::Test {
 protected:
  LayoutTest() : layout_(json::parse(std::ifstream(test::source_path("config/foxglove/curbstone.json")))) {
    for (const Channel& channel : fixed_channels()) topics_.insert(channel.topic);
  }
  json layout_;
  std::set<std::string> topics_;
};

TEST_F(LayoutTest, NamesTopicsThatThereAre) {
  const json& configs = layout_["configById"];
  for (const auto& [topic, settings] : configs["3D!curbstone"]["topics"].items()) EXPECT_THAT(topics_, Contains(topic));
  EXPECT_THAT(topics_, Contains(configs["RosOut!faults"]["topicToRender"]));
  for (const auto& [id, config] : configs.items()) {
    if (!config.contains("paths")) continue;
    for (const json& path : config["paths"]) EXPECT_THAT(path["value"].get<std::string>(), StartsWith("/status/"));
  }
}

TEST_F(LayoutTest, HasAPlaceForEachPanel) {
  for (const std::string& panel : panels_in(layout_["layout"]))
    EXPECT_TRUE(layout_["configById"].contains(panel)) << panel;
  EXPECT_EQ(panels_in(layout_["layout"]).size(), layout_["configById"].size());
}

}  // namespace
}  // namespace curbstone::viewer::foxglove
