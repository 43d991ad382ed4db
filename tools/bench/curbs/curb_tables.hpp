#pragma once

#include <string>
#include <vector>

#include "tools/bench/curbs/scores/bin_score.hpp"
#include "tools/bench/curbs/scores/street_score.hpp"
#include "tools/evaluate/evaluation.hpp"

namespace curbstone::bench::curbs {

/// Scores of one scene, one per seed.
struct SceneFigures {
  std::string name;
  std::vector<scores::BinScore> scores;
};

/// Scores of one cloud of the labelled street with one method.
struct StreetFigures {
  std::string cloud;
  std::string method;
  std::vector<std::vector<scores::StreetScore>> turns;  ///< by orientation on the grid, then by kTolerances
};

/// Scores of one kind of complete drive with one method, one evaluation per seed.
struct DriveFigures {
  std::string name;
  std::string method;
  std::vector<evaluate::Evaluation> seeds;
};

/// As text, for people.
[[nodiscard]] std::string to_table(const std::string& title, const std::vector<SceneFigures>& scenes);
[[nodiscard]] std::string to_table(const std::vector<StreetFigures>& street);
[[nodiscard]] std::string to_table(const std::vector<DriveFigures>& drives);

/// All figures, for the JSON file.
struct CurbFigures {
  std::vector<SceneFigures> scans, drives;
  std::vector<DriveFigures> towns;
  std::vector<StreetFigures> street;
};
[[nodiscard]] std::string to_json(const CurbFigures& figures);

}  // namespace curbstone::bench::curbs
