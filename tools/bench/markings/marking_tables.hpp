#pragma once

#include <string>
#include <vector>

#include "tools/bench/markings/marking_score.hpp"

namespace curbstone::bench::markings {

struct StreetFigures {
  std::string cloud;
  std::string method;
  CellScore score;
};
struct TownFigures {
  std::string town;
  std::string method;
  LineScore score;  ///< of all seeds
};
struct MarkingFigures {
  std::vector<StreetFigures> street;
  std::vector<TownFigures> towns;
};

[[nodiscard]] std::string to_table(const std::vector<StreetFigures>& figures);
[[nodiscard]] std::string to_table(const std::vector<TownFigures>& figures);
[[nodiscard]] std::string to_json(const MarkingFigures& figures);

}  // namespace curbstone::bench::markings
