#include "drivers/lidar/models/make_model.hpp"

#include "drivers/lidar/models/helios/helios_model.hpp"
#include "drivers/lidar/models/rs16/rs16_model.hpp"
#include "drivers/lidar/models/vlp16/vlp16_model.hpp"

namespace curbstone::lidar::models {

std::vector<const ModelTable*> tables() {
  return {&rs16::kTable, &helios::k16p.table, &helios::k32.table, &vlp16::kTable};
}

const ModelTable& table_of(ModelName name) {
  switch (name) {
    case ModelName::kAuto:
    case ModelName::kRs16:
      return rs16::kTable;
    case ModelName::kHelios16p:
      return helios::k16p.table;
    case ModelName::kHelios32:
      return helios::k32.table;
    case ModelName::kVlp16:
      return vlp16::kTable;
  }
  return rs16::kTable;
}

std::unique_ptr<Model> make_model(ModelName name, const ModelSettings& settings) {
  switch (name) {
    case ModelName::kAuto:
      return nullptr;
    case ModelName::kRs16:
      return std::make_unique<rs16::Rs16Model>(settings);
    case ModelName::kHelios16p:
      return std::make_unique<helios::HeliosModel>(helios::k16p, settings);
    case ModelName::kHelios32:
      return std::make_unique<helios::HeliosModel>(helios::k32, settings);
    case ModelName::kVlp16:
      return std::make_unique<vlp16::Vlp16Model>(settings);
  }
  return nullptr;
}

}  // namespace curbstone::lidar::models
