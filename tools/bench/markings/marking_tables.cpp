#include "tools/bench/markings/marking_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "common/statistics/quantile.hpp"

namespace curbstone::bench::markings {
namespace {

double lateral_cm(const LineScore& score) {
  return 100 * quantile_or(score.lateral, 0.5, 0);
}
double false_in_200_m(const LineScore& score) {
  return score.driven > 0 ? 200 * score.false_metres / score.driven : 0;
}

constexpr std::array<const char*, semantic_map::tile::kNumMarkingTypes> kTypeNames = {"unknown",   "solid",    "dashed",
                                                                                      "stop line", "crossing", "other"};

/// Length of which the type is wrong.
struct WrongType {
  double metres = 0;
  const char* is = "";
  const char* found = "";
};

/// The longest first.
std::vector<WrongType> wrong_types(const LineScore& score) {
  std::vector<WrongType> wrong;
  for (std::size_t is = 0; is < score.types.size(); ++is) {
    for (std::size_t found = 0; found < score.types.size(); ++found) {
      const double metres = score.types[is][found];
      if (is != found && metres > 0) wrong.push_back({metres, kTypeNames[is], kTypeNames[found]});
    }
  }
  std::stable_sort(wrong.begin(), wrong.end(), [](const auto& a, const auto& b) { return a.metres > b.metres; });
  return wrong;
}

nlohmann::ordered_json wrong_types_json(const LineScore& score) {
  auto json = nlohmann::ordered_json::array();
  for (const WrongType& w : wrong_types(score)) json.push_back({{"is", w.is}, {"found", w.found}, {"m", w.metres}});
  return json;
}

}  // namespace

std::string to_table(const std::vector<StreetFigures>& figures) {
  std::string text =
      fmt::format("{:<14}{:<34}{:>7}{:>7}{:>7}{:>8}{:>8}\n", "street", "method", "P", "R", "F1", "found", "truth");
  for (const StreetFigures& f : figures)
    text += fmt::format("{:<14}{:<34}{:>7.3f}{:>7.3f}{:>7.3f}{:>8.0f}{:>8.0f}\n", f.cloud, f.method,
                        f.score.precision(), f.score.recall(), f.score.f1(), f.score.found, f.score.painted);
  return text;
}

std::string to_table(const std::vector<TownFigures>& figures) {
  std::string text = fmt::format("{:<24}{:<24}{:>7}{:>7}{:>7}{:>9}{:>8}{:>9}{:>9}\n", "town", "method", "P", "R", "F1",
                                 "lateral", "typed", "metres", "false/200");
  for (const TownFigures& f : figures)
    text += fmt::format("{:<24}{:<24}{:>7.3f}{:>7.3f}{:>7.3f}{:>9.2f}{:>8.3f}{:>9.1f}{:>9.2f}\n", f.town, f.method,
                        f.score.cells.precision(), f.score.cells.recall(), f.score.cells.f1(), lateral_cm(f.score),
                        f.score.type_share(), f.score.right_metres, false_in_200_m(f.score));
  for (const TownFigures& f : figures) {
    for (const WrongType& w : wrong_types(f.score))
      text += fmt::format("{:<24}{:<24}{} as {}: {:.1f} m\n", f.town, f.method, w.is, w.found, w.metres);
  }
  return text;
}

std::string to_json(const MarkingFigures& figures) {
  nlohmann::ordered_json json;
  json["tolerance_m"] = kTolerance;
  json["street"] = nlohmann::ordered_json::array();
  for (const StreetFigures& f : figures.street)
    json["street"].push_back({{"cloud", f.cloud},
                              {"method", f.method},
                              {"precision", f.score.precision()},
                              {"recall", f.score.recall()},
                              {"f1", f.score.f1()},
                              {"true_cells", f.score.painted}});
  json["towns"] = nlohmann::ordered_json::array();
  for (const TownFigures& f : figures.towns)
    json["towns"].push_back({{"town", f.town},
                             {"method", f.method},
                             {"precision", f.score.cells.precision()},
                             {"recall", f.score.cells.recall()},
                             {"f1", f.score.cells.f1()},
                             {"lateral_median_cm", lateral_cm(f.score)},
                             {"type_share", f.score.type_share()},
                             {"wrong_types", wrong_types_json(f.score)},
                             {"right_m", f.score.right_metres},
                             {"false_m", f.score.false_metres},
                             {"driven_m", f.score.driven},
                             {"false_m_in_200", false_in_200_m(f.score)}});
  return json.dump(2) + "\n";
}

}  // namespace curbstone::bench::markings
