#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "drivers/lidar/models/base/model.hpp"

namespace curbstone::lidar::models {

/// The supported models. To add one: a folder with its table and its decoder, and a line each in `tables()`,
/// `table_of()` and `make_model()`.
enum class ModelName { kAuto, kRs16, kHelios16p, kHelios32, kVlp16 };

/// The tables of all models.
[[nodiscard]] std::vector<const ModelTable*> tables();
/// For kAuto: the first model's.
[[nodiscard]] const ModelTable& table_of(ModelName name);

/// nullptr for kAuto. Throws std::runtime_error with a one-line message if the settings do not fit the model.
[[nodiscard]] std::unique_ptr<Model> make_model(ModelName name, const ModelSettings& settings);

}  // namespace curbstone::lidar::models
