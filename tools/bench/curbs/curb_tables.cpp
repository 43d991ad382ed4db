#include "tools/bench/curbs/curb_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/evaluate/report.hpp"

namespace curbstone::bench::curbs {

namespace {

struct MeanAndSpread {
  double mean = 0;
  double spread = 0;  ///< standard deviation over the seeds
};

template <class Get>
MeanAndSpread over_seeds(const std::vector<scores::BinScore>& scores, Get get) {
  MeanAndSpread result;
  const auto n = static_cast<double>(scores.size());
  for (const scores::BinScore& s : scores) result.mean += get(s) / n;
  for (const scores::BinScore& s : scores) result.spread += std::pow(get(s) - result.mean, 2) / std::max(1.0, n - 1);
  result.spread = std::sqrt(result.spread);
  return result;
}

double precision_of(const scores::BinScore& s) {
  return s.precision;
}
double recall_of(const scores::BinScore& s) {
  return s.recall;
}
double f1_of(const scores::BinScore& s) {
  return s.f1();
}
double rmse_cm(const scores::BinScore& s) {
  return 100 * s.rmse;
}
double wrong_bins(const scores::BinScore& s) {
  return s.wrong;
}
double bias_cm(const scores::BinScore& s) {
  return 100 * s.bias;
}

/// Pools all turns at one tolerance.
scores::StreetScore pooled_at(const StreetFigures& figures, std::size_t tolerance) {
  std::vector<scores::StreetScore> scores;
  for (const auto& turn : figures.turns) scores.push_back(turn[tolerance]);
  return scores::pooled(scores);
}

double least_f1(const StreetFigures& figures) {
  double least = 1;
  for (const auto& turn : figures.turns) least = std::min(least, turn.back().score().f1());
  return least;
}

/// Mean figures of drives with truth.
struct DriveMeans {
  std::array<evaluate::Score, evaluate::kTolerances.size()> at{};
  double least_f1 = 1;  ///< at the widest tolerance
  double bias_cm = 0, spread_cm = 0;
  double class_accuracy = 0, blocking_recall = 0;
};

DriveMeans means_of(const std::vector<evaluate::Evaluation>& seeds) {
  DriveMeans mean;
  const auto n = static_cast<double>(seeds.size());
  for (const evaluate::Evaluation& seed : seeds) {
    const evaluate::CurbScore& curbs = seed.curbs.value();
    for (std::size_t i = 0; i < evaluate::kTolerances.size(); ++i) {
      mean.at[i].precision += curbs.at[i].precision / n;
      mean.at[i].recall += curbs.at[i].recall / n;
    }
    mean.least_f1 = std::min(mean.least_f1, curbs.at.back().f1());
    mean.bias_cm += curbs.lateral_bias_cm / n;
    mean.spread_cm += curbs.lateral_spread_cm / n;
    mean.class_accuracy += seed.classes.value().accuracy() / n;
    mean.blocking_recall += seed.blocking.value().recall() / n;
  }
  return mean;
}

nlohmann::json to_json(const std::vector<SceneFigures>& scenes) {
  nlohmann::json list = nlohmann::json::array();
  for (const SceneFigures& scene : scenes) {
    const auto pair = [&](auto get) {
      const MeanAndSpread m = over_seeds(scene.scores, get);
      return nlohmann::json{{"mean", m.mean}, {"spread", m.spread}};
    };
    list.push_back({{"scene", scene.name},
                    {"seeds", scene.scores.size()},
                    {"precision", pair(precision_of)},
                    {"recall", pair(recall_of)},
                    {"f1", pair(f1_of)},
                    {"wrong_bins", pair(wrong_bins)},
                    {"rmse_cm", pair(rmse_cm)},
                    {"bias_cm", pair(bias_cm)}});
  }
  return list;
}

}  // namespace

std::string to_table(const std::string& title, const std::vector<SceneFigures>& scenes) {
  std::string text = fmt::format("{:<34} {:>11} {:>11} {:>11} {:>9} {:>6} {:>11}\n", title, "P", "R", "F1", "rmse cm",
                                 "bias", "wrong bins");
  for (const SceneFigures& scene : scenes) {
    const auto pair = [&](auto get) {
      const MeanAndSpread m = over_seeds(scene.scores, get);
      return fmt::format("{:.3f}+-{:.3f}", m.mean, m.spread);
    };
    const bool has_curbs =
        std::any_of(scene.scores.begin(), scene.scores.end(), [](const auto& s) { return s.bins > 0; });
    const double wrong = over_seeds(scene.scores, wrong_bins).mean;
    if (!has_curbs) {
      text += fmt::format("  {:<85} {:>11.1f}\n", scene.name, wrong);
      continue;
    }
    text += fmt::format("  {:<32} {} {} {} {:>4.1f}+-{:.1f} {:>+6.1f} {:>11.1f}\n", scene.name, pair(precision_of),
                        pair(recall_of), pair(f1_of), over_seeds(scene.scores, rmse_cm).mean,
                        over_seeds(scene.scores, rmse_cm).spread, over_seeds(scene.scores, bias_cm).mean, wrong);
  }
  return text;
}

std::string to_table(const std::vector<StreetFigures>& street) {
  std::string text = fmt::format("{:<22}", "labelled street");
  for (const double tolerance : evaluate::kTolerances) text += fmt::format("  P/R/F1 at {:.2f} m ", tolerance);
  text += "  least   bias  spread cm   recall <1.5 <3 <4 <5 >5 cm   counted/not\n";
  for (const StreetFigures& f : street) {
    text += fmt::format("  {:<9} {:<10}", f.cloud, f.method);
    for (std::size_t i = 0; i < evaluate::kTolerances.size(); ++i) {
      const evaluate::Score score = pooled_at(f, i).score();
      text += fmt::format("  {:.3f} {:.3f} {:.3f}", score.precision, score.recall, score.f1());
    }
    const scores::StreetScore widest = pooled_at(f, evaluate::kTolerances.size() - 1);
    text += fmt::format("  {:.3f}  {:+5.1f} {:5.1f}            ", least_f1(f), 100 * widest.bias, 100 * widest.spread);
    for (const evaluate::Score& step : widest.by_step) text += fmt::format(" {:.2f}", step.recall);
    text += fmt::format("   {}/{}\n", widest.detections, widest.dont_care);
  }
  return text;
}

std::string to_table(const std::vector<DriveFigures>& drives) {
  std::string text = fmt::format("{:<34} seeds", "whole drives");
  for (const double tolerance : evaluate::kTolerances) text += fmt::format("  P/R/F1 at {:.2f} m ", tolerance);
  text += "  least   bias  spread cm   classes   blocking recall\n";
  for (const DriveFigures& d : drives) {
    const DriveMeans mean = means_of(d.seeds);
    text += fmt::format("  {:<21} {:<10} {:5}", d.name, d.method, d.seeds.size());
    for (const evaluate::Score& at : mean.at)
      text += fmt::format("  {:.3f} {:.3f} {:.3f}", at.precision, at.recall, at.f1());
    text += fmt::format("  {:.3f}  {:+5.1f} {:5.1f}       {:.3f}     {:.4f}\n", mean.least_f1, mean.bias_cm,
                        mean.spread_cm, mean.class_accuracy, mean.blocking_recall);
  }
  return text;
}

std::string to_json(const CurbFigures& figures) {
  nlohmann::json json = {{"scans", to_json(figures.scans)}, {"drives", to_json(figures.drives)}};
  json["towns"] = nlohmann::json::array();
  for (const DriveFigures& d : figures.towns) {
    for (std::size_t k = 0; k < d.seeds.size(); ++k) {
      nlohmann::json entry = nlohmann::json::parse(to_json(d.seeds[k]));
      entry["drive"] = d.name;
      entry["method"] = d.method;
      entry["seed"] = k + 1;
      if (d.seeds[k].blocking) entry["blocking_recall"] = d.seeds[k].blocking->recall();
      json["towns"].push_back(std::move(entry));
    }
  }
  json["street"] = nlohmann::json::array();
  for (const StreetFigures& f : figures.street) {
    const scores::StreetScore widest = pooled_at(f, evaluate::kTolerances.size() - 1);
    nlohmann::json entry = {{"cloud", f.cloud},
                            {"method", f.method},
                            {"turns", f.turns.size()},
                            {"least_f1", least_f1(f)},
                            {"bias_cm", 100 * widest.bias},
                            {"spread_cm", 100 * widest.spread},
                            {"detections", widest.detections},
                            {"not_counted", widest.dont_care}};
    for (std::size_t i = 0; i < evaluate::kTolerances.size(); ++i) {
      const evaluate::Score score = pooled_at(f, i).score();
      entry[fmt::format("{:.2f}", evaluate::kTolerances[i])] = {
          {"precision", score.precision}, {"recall", score.recall}, {"f1", score.f1()}};
    }
    json["street"].push_back(std::move(entry));
  }
  return json.dump(2) + "\n";
}

}  // namespace curbstone::bench::curbs
