#include "common/json/json_text.hpp"

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

namespace curbstone {

std::string json_text(const nlohmann::json& value, int indent) {
  return value.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

nlohmann::json parse_json(std::string_view text) {
  return nlohmann::json::parse(text);
}

nlohmann::json read_json(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return parse_json(std::string(std::istreambuf_iterator<char>(in), {}));
}

nlohmann::json try_parse_json(std::string_view text) {
  return nlohmann::json::parse(text, nullptr, false);
}

}  // namespace curbstone
