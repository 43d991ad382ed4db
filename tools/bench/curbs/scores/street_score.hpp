#pragma once

#include <array>
#include <vector>

#include "tools/evaluate/curb_score.hpp"
#include "tools/evaluate/truth/street_labels.hpp"

namespace curbstone::bench::curbs::scores {

/// Bounds between the classes of true step height for which recall is stated, m.
inline constexpr std::array kTrueStepBounds = {0.015, 0.03, 0.04, 0.05};

/// The verdict on a detection, by the strict rule. It is right within the tolerance of a true step of 4 cm or more. It
/// does not count within 0.24 m of another border (for example a lower step), where one side has no label, where two
/// surfaces meet but the labels are too sparse to locate the border, or in the sensor's blind disc. Otherwise it is
/// wrong.
enum class Verdict { kRight, kWrong, kNotCounted };
[[nodiscard]] Verdict judge(const evaluate::CurbFoot& detection, const evaluate::truth::StreetLabels& truth,
                            double tolerance);

/// Score of the detections against a labelled street.
struct StreetScore {
  int truth = 0, found = 0;
  int detections = 0, right = 0;  ///< only those that count
  int dont_care = 0;
  double bias = 0;    ///< m, median of the lateral error, positive towards the higher side
  double spread = 0;  ///< m, 1.48 * median deviation from the bias
  std::array<evaluate::Score, kTrueStepBounds.size() + 1> by_step{};  ///< recall only
  [[nodiscard]] evaluate::Score score() const {
    return {detections > 0 ? static_cast<double>(right) / detections : 0,
            truth > 0 ? static_cast<double>(found) / truth : 0};
  }
};

/// All in the truth's frame, whose origin is the sensor; m.
[[nodiscard]] StreetScore score_street(const std::vector<evaluate::CurbFoot>& detections,
                                       const evaluate::truth::StreetLabels& truth, double tolerance, double range = 15);

/// Pools several scores: sums of counts; means of bias, spread and recall by step.
[[nodiscard]] StreetScore pooled(const std::vector<StreetScore>& scores);

}  // namespace curbstone::bench::curbs::scores
