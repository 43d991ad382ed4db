#include "common/config/assignments.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace curbstone {

std::vector<std::string> assignments_for(SectionNames sections, const std::vector<std::string>& assignments) {
  std::vector<std::string> all;
  for (const std::string& assignment : assignments) {
    const std::string_view key = std::string_view(assignment).substr(0, assignment.find('='));
    const std::string_view section = key.substr(0, key.find('.'));
    if (section.size() < key.size() && section == "vehicle") {
      for (const std::string_view own : sections) all.push_back(fmt::format("{}.{}", own, assignment));
    } else if (section.size() < key.size() && std::find(sections.begin(), sections.end(), section) != sections.end()) {
      all.push_back(assignment);
    } else {
      throw ConfigError(fmt::format("--set {}: expected SECTION.KEY=VALUE, the section being vehicle or one of {}",
                                    assignment, fmt::join(sections, ", ")));
    }
  }
  return all;
}

}  // namespace curbstone
