#pragma once

#include <array>
#include <vector>

#include "tools/evaluate/curb_score.hpp"
#include "tools/evaluate/truth/street_labels.hpp"

namespace curbstone::bench::curbs::scores {

/// Bounds between the classes of true steps that recall is stated for: m.
inline constexpr std::array kTrueStepBounds = {0.015, 0.03, 0.04, 0.05};

/// What a detection is worth, the strict way: right within the tolerance of a true step of 4 cm or more; it does not
/// count within 0.24 m of another border (a lower step, say), where one side has no label, where two surfaces meet
/// but labels are too thin to say where, or in the sensor's blind disc; else it is wrong.
enum class Verdict { kRight, kWrong, kNotCounted };
[[nodiscard]] Verdict judge(const evaluate::CurbFoot& detection, const evaluate::truth::StreetLabels& truth,
                            double tolerance);

/// Detections against a labelled street.
struct StreetScore {
  int truth = 0, found = 0;
  int detections = 0, right = 0;  ///< of those that count
  int dont_care = 0;
  double bias = 0;    ///< m, median of the lateral error, positive towards the higher side
  double spread = 0;  ///< m, 1.48 * median deviation from the bias
  std::array<evaluate::Score, kTrueStepBounds.size() + 1> by_step{};  ///< recall only
  [[nodiscard]] evaluate::Score score() const {
    return {detections > 0 ? static_cast<double>(right) / detections : 0,
            truth > 0 ? static_cast<double>(found) / truth : 0};
  }
};

/// All in the frame of the truth, whose origin is the sensor; m.
[[nodiscard]] StreetScore score_street(const std::vector<evaluate::CurbFoot>& detections,
                                       const evaluate::truth::StreetLabels& truth, double tolerance, double range = 15);

/// Several together: counts added up, bias, spread and recall by step on average.
[[nodiscard]] StreetScore pooled(const std::vector<StreetScore>& scores);

}  // namespace curbstone::bench::curbs::scores
