// A vehicle's file, as each process reads it. Input: which process (1 byte), whether as a file or as an assignment
// SECTION.KEY=VALUE (1 byte), text. What was taken is dumped, and the dump means the same.
#include "common/config/config.hpp"

#include <functional>
#include <vector>

#include "common/config/vehicle.hpp"
#include "config/sections.hpp"
#include "drivers/encoder/encoder_config.hpp"
#include "drivers/imu/imu_config.hpp"
#include "drivers/lidar/lidar_config.hpp"
#include "services/ekf/base/ekf_config.hpp"
#include "services/mapper/config/mapper_config.hpp"
#include "services/recorder/recorder_config.hpp"
#include "services/semantic_map/semantic_map_config.hpp"
#include "services/tensor_voting/worker/tensor_voting_config.hpp"
#include "tests/fuzz/support/input.hpp"
#include "tests/fuzz/support/require.hpp"

namespace curbstone::fuzz {
namespace {

template <class Config>
void read_as(const char* section, bool assign, std::string_view text) {
  ConfigOf<Config> config;
  try {
    if (assign)
      set_config_value(text, config);
    else
      parse_config(text, "fuzz", section, kProcessSections, config);
  } catch (const ConfigError&) {
    return;  // and said so
  }
  const std::string dump = dump_config(section, config);
  ConfigOf<Config> again;
  parse_config(dump, "dump", section, kProcessSections, again);
  require(dump_config(section, again) == dump, "a dumped configuration is read as the same");
}

}  // namespace
}  // namespace curbstone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  fuzz::Input input(data, size);
  const auto process = input.number<std::uint8_t>() % 9;
  const bool assign = (input.number<std::uint8_t>() & 1) != 0;
  const std::string_view text = fuzz::text(input.rest());
  switch (process) {
    case 0:
      fuzz::read_as<lidar::LidarConfig>("lidar", assign, text);
      break;
    case 1:
      fuzz::read_as<imu::ImuConfig>("imu", assign, text);
      break;
    case 2:
      fuzz::read_as<encoder::EncoderConfig>("encoder", assign, text);
      break;
    case 3:
      fuzz::read_as<ekf::base::EkfConfig>("ekf", assign, text);
      break;
    case 4:
      fuzz::read_as<mapper::config::MapperConfig>("mapper", assign, text);
      break;
    case 5:
      fuzz::read_as<tensor_voting::worker::TensorVotingConfig>("tensor_voting", assign, text);
      break;
    case 6:
      fuzz::read_as<semantic_map::SemanticMapConfig>("semantic_map", assign, text);
      break;
    case 7:
      fuzz::read_as<recorder::RecorderConfig>("recorder", assign, text);
      break;
    default:
      fuzz::read_as<VehicleConfig>("vehicle", assign, text);
      break;
  }
  return 0;
}
