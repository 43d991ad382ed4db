#include "services/recorder/config_cache.hpp"

#include <fmt/format.h>

#include <curbstone/service_config_t.hpp>

#include "common/bus/decode.hpp"

namespace curbstone::recorder {

bool ConfigCache::take(const void* data, int size) {
  service_config_t message;
  if (!decode(data, size, message)) return false;
  const std::string id = message.service + " on " + message.host;
  if (by_service_.size() >= kMaxProcesses && !by_service_.contains(id)) return false;
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  Known& known = by_service_[id];
  const bool is_new = known.bytes.empty() || known.yaml != message.yaml || known.version != message.version;
  known = {message.section, message.yaml, message.version, message.host, {bytes, bytes + size}};
  return is_new;
}

void ConfigCache::write(LogWriter& log, std::int64_t utime) const {
  for (const auto& [id, known] : by_service_)
    log.write("CONFIG", known.bytes.data(), static_cast<int>(known.bytes.size()), utime);
}

std::string ConfigCache::yaml() const {
  std::string text =
      "# How the processes of this recording were configured. 'curbstone replay' takes it from the log.\n";
  std::map<std::string, const Known*> sections;
  for (const auto& [id, known] : by_service_) {
    const auto [first, is_new] = sections.try_emplace(known.section, &known);
    if (is_new) {
      text += fmt::format("\n# {}, version {}\n{}", id, known.version, known.yaml);
    } else if (first->second->yaml != known.yaml) {
      text += fmt::format("# {} is configured otherwise: see its CONFIG in the log\n", id);
    }
  }
  return text;
}

}  // namespace curbstone::recorder
