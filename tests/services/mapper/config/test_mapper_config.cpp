#include "services/mapper/config/mapper_config.hpp"

#include <gtest/gtest.h>

#include <string>

#include "config/sections.hpp"

namespace curbstone::mapper::config {
namespace {

TEST(MapperConfig, ModesAreNamedInTheFile) {
  ConfigOf<MapperConfig> config;
  parse_config("mapper:\n  mode: localise\n  method: loam\n", "ugv.yaml", "mapper", kProcessSections, config);
  EXPECT_EQ(config.value.mode, MapMode::kLocalise);
  EXPECT_EQ(config.value.registration.method, RegistrationMethod::kLoam);
  set_config_value("mode=extend", config);
  EXPECT_EQ(config.value.mode, MapMode::kExtend);
  EXPECT_EQ(config.value.registration.method, RegistrationMethod::kLoam) << "the others stay";
}

TEST(MapperConfig, AModeThatIsNoneIsRefusedWithThoseThatAre) {
  ConfigOf<MapperConfig> config;
  try {
    parse_config("mapper:\n  mode: follow\n", "ugv.yaml", "mapper", kProcessSections, config);
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "ugv.yaml:2: mapper.mode: 'follow' is not one of map, extend, localise");
  }
}

TEST(MapperConfig, WhatIsDumpedIsReadBack) {
  ConfigOf<MapperConfig> config;
  config.value.mode = MapMode::kExtend;
  config.value.registration.method = RegistrationMethod::kLoam;
  config.value.tracker.max_speed = 12;
  const std::string dumped = dump_config("mapper", config);
  EXPECT_NE(dumped.find("  mode: extend  # "), std::string::npos) << dumped;
  EXPECT_NE(dumped.find("(map | extend | localise)"), std::string::npos) << dumped;
  ConfigOf<MapperConfig> read;
  parse_config(dumped, "dump", "mapper", kProcessSections, read);
  EXPECT_EQ(dump_config("mapper", read), dumped);
  EXPECT_EQ(read.value.mode, MapMode::kExtend);
}

}  // namespace
}  // namespace curbstone::mapper::config
