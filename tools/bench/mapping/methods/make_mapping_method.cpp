#include "tools/bench/mapping/methods/make_mapping_method.hpp"

#include "common/config/config.hpp"
#include "tools/bench/mapping/methods/mapper_method.hpp"
#include "tools/bench/mapping/methods/pcl_method.hpp"

namespace curbstone::bench::mapping::methods {

std::vector<std::string> mapping_methods() {
  return {"icp", "loam", "pcl_icp", "pcl_gicp", "pcl_ndt"};
}

std::unique_ptr<MappingMethod> make_mapping_method(const std::string& name, const drives::MappingDrive& drive,
                                                   const std::vector<std::string>& settings) {
  if (name == "pcl_icp") return std::make_unique<PclMethod>(PclMethod::Kind::kIcp, drive.vehicle);
  if (name == "pcl_gicp") return std::make_unique<PclMethod>(PclMethod::Kind::kGicp, drive.vehicle);
  if (name == "pcl_ndt") return std::make_unique<PclMethod>(PclMethod::Kind::kNdt, drive.vehicle);
  ConfigOf<mapper::config::MapperConfig> config;
  config.value.vehicle = drive.vehicle;
  config.value.dense.min_height += drive.ground;
  config.value.dense.max_height += drive.ground;
  set_config_value("method=" + name, config);
  for (const std::string& setting : settings) set_config_value(setting, config);
  return std::make_unique<MapperMethod>(config.value);
}

}  // namespace curbstone::bench::mapping::methods
