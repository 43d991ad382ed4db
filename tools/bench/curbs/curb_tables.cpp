#include "tools/bench/curbs/curb_tables.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/evaluate/report.hpp"

namespace curbstone {

namespace {

struct MeanAndSpread {
  double mean = 0;
  double spread = 0;  ///< standard deviation over the seeds
};

template <class Get>
MeanAndSpread over_seeds(const std::vector<BinScore>& scores, Get get) {
  MeanAndSpread result;
  const auto n = static_cast<double>(scores.size());
  for (const BinScore& s : scores) result.mean += get(s) / n;
  for (const BinScore& s : scores) result.spread += std::pow(get(s) - result.mean, 2) / std::max(1.0, n - 1);
  result.spread = std::sqrt(result.spread);
  return result;
}

double precision_of(const BinScore& s) {
  return s.precision;
}
double recall_of(const BinScore& s) {
  return s.recall;
}
double f1_of(const BinScore& s) {
  return s.f1();
}
double rmse_cm(const BinScore& s) {
  return 100 * s.rmse;
}
double bias_cm(const BinScore& s) {
  return 100 * s.bias;
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
                    {"rmse_cm", pair(rmse_cm)},
                    {"bias_cm", pair(bias_cm)}});
  }
  return list;
}

}  // namespace

std::string to_table(const std::string& title, const std::vector<SceneFigures>& scenes) {
  std::string text = fmt::format("{:<34} {:>11} {:>11} {:>11} {:>9} {:>6}\n", title, "P", "R", "F1", "rmse cm", "bias");
  for (const SceneFigures& scene : scenes) {
    const auto pair = [&](auto get) {
      const MeanAndSpread m = over_seeds(scene.scores, get);
      return fmt::format("{:.3f}+-{:.3f}", m.mean, m.spread);
    };
    text += fmt::format("  {:<32} {} {} {} {:>4.1f}+-{:.1f} {:>+6.1f}\n", scene.name, pair(precision_of),
                        pair(recall_of), pair(f1_of), over_seeds(scene.scores, rmse_cm).mean,
                        over_seeds(scene.scores, rmse_cm).spread, over_seeds(scene.scores, bias_cm).mean);
  }
  return text;
}

std::string to_table(const std::vector<StreetFigures>& street) {
  std::string text = fmt::format("{:<22}", "labelled street");
  for (const double tolerance : kTolerances) text += fmt::format("  P/R/F1 at {:.2f} m ", tolerance);
  text += "  bias  spread cm   recall <1.5 <3 <4 <5 >5 cm   counted/not\n";
  for (const StreetFigures& f : street) {
    text += fmt::format("  {:<9} {:<10}", f.cloud, f.method);
    for (const StreetScore& s : f.scores) {
      const Score score = s.score();
      text += fmt::format("  {:.3f} {:.3f} {:.3f}", score.precision, score.recall, score.f1());
    }
    const StreetScore& widest = f.scores.back();
    text += fmt::format("  {:+5.1f} {:5.1f}            ", 100 * widest.bias, 100 * widest.spread);
    for (const Score& step : widest.by_step) text += fmt::format(" {:.2f}", step.recall);
    text += fmt::format("   {}/{}\n", widest.detections, widest.dont_care);
  }
  return text;
}

std::string to_table(const std::vector<DriveFigures>& drives) {
  std::string text;
  for (const DriveFigures& d : drives) text += fmt::format("{}, {}\n{}", d.name, d.method, to_table(d.evaluation));
  return text;
}

std::string to_json(const CurbFigures& figures) {
  nlohmann::json json = {{"scans", to_json(figures.scans)}, {"drives", to_json(figures.drives)}};
  json["towns"] = nlohmann::json::array();
  for (const DriveFigures& d : figures.towns) {
    nlohmann::json entry = nlohmann::json::parse(to_json(d.evaluation));
    entry["drive"] = d.name;
    entry["method"] = d.method;
    if (d.evaluation.blocking) entry["blocking_recall"] = d.evaluation.blocking->recall();
    json["towns"].push_back(std::move(entry));
  }
  json["street"] = nlohmann::json::array();
  for (const StreetFigures& f : figures.street) {
    nlohmann::json entry = {{"cloud", f.cloud},
                            {"method", f.method},
                            {"bias_cm", 100 * f.scores.back().bias},
                            {"spread_cm", 100 * f.scores.back().spread},
                            {"detections", f.scores.back().detections},
                            {"not_counted", f.scores.back().dont_care}};
    for (std::size_t i = 0; i < f.scores.size(); ++i) {
      const Score score = f.scores[i].score();
      entry[fmt::format("{:.2f}", kTolerances[i])] = {
          {"precision", score.precision}, {"recall", score.recall}, {"f1", score.f1()}};
    }
    json["street"].push_back(std::move(entry));
  }
  return json.dump(2) + "\n";
}

}  // namespace curbstone
