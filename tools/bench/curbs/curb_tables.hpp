#pragma once

#include <string>
#include <vector>

#include "tools/bench/curbs/scores/bin_score.hpp"
#include "tools/bench/curbs/scores/street_score.hpp"
#include "tools/evaluate/evaluation.hpp"

namespace curbstone::bench::curbs {

/// What one scene came to, one score a seed.
struct SceneFigures {
  std::string name;
  std::vector<scores::BinScore> scores;
};

/// One cloud of the labelled street, by one way of looking for curbs.
struct StreetFigures {
  std::string cloud;
  std::string method;
  std::vector<std::vector<scores::StreetScore>> turns;  ///< the way it lies on the grid, and of that by kTolerances
};

/// A kind of whole drive, by one way of looking for curbs: an evaluation a seed.
struct DriveFigures {
  std::string name;
  std::string method;
  std::vector<evaluate::Evaluation> seeds;
};

/// For people.
[[nodiscard]] std::string to_table(const std::string& title, const std::vector<SceneFigures>& scenes);
[[nodiscard]] std::string to_table(const std::vector<StreetFigures>& street);
[[nodiscard]] std::string to_table(const std::vector<DriveFigures>& drives);

/// All figures, for programs.
struct CurbFigures {
  std::vector<SceneFigures> scans, drives;
  std::vector<DriveFigures> towns;
  std::vector<StreetFigures> street;
};
[[nodiscard]] std::string to_json(const CurbFigures& figures);

}  // namespace curbstone::bench::curbs
