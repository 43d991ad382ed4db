#include "tools/bench/mapping/mapping_method.hpp"

#include "tools/bench/mapping/mapper_method.hpp"
#include "tools/bench/mapping/pcl_method.hpp"

namespace curbstone {

std::vector<std::string> mapping_methods() {
  return {"icp", "loam", "pcl_icp", "pcl_gicp", "pcl_ndt"};
}

std::unique_ptr<MappingMethod> make_mapping_method(const std::string& name, const MappingDrive& drive,
                                                   const std::vector<std::string>& settings) {
  if (name == "pcl_icp") return std::make_unique<PclMethod>(PclMethod::Kind::kIcp, drive.vehicle);
  if (name == "pcl_gicp") return std::make_unique<PclMethod>(PclMethod::Kind::kGicp, drive.vehicle);
  if (name == "pcl_ndt") return std::make_unique<PclMethod>(PclMethod::Kind::kNdt, drive.vehicle);
  ConfigOf<MapperConfig> config;
  config.value.vehicle = drive.vehicle;
  config.value.dense.min_height += drive.ground;
  config.value.dense.max_height += drive.ground;
  set_config_value("method=" + name, config);
  for (const std::string& setting : settings) set_config_value(setting, config);
  return std::make_unique<MapperMethod>(config.value);
}

}  // namespace curbstone
