#include "drivers/lidar/models/make_model.hpp"

#include "drivers/lidar/models/rs16/rs16_model.hpp"

namespace curbstone::lidar::models {

std::vector<const ModelTable*> tables() {
  return {&rs16::kTable};
}

const ModelTable& table_of(ModelName name) {
  (void)name;
  return rs16::kTable;
}

std::unique_ptr<Model> make_model(ModelName name, const ModelSettings& settings) {
  if (name == ModelName::kAuto) return nullptr;
  return std::make_unique<rs16::Rs16Model>(settings);
}

}  // namespace curbstone::lidar::models
