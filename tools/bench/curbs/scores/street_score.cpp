#include "tools/bench/curbs/scores/street_score.hpp"

#include <algorithm>
#include <cmath>

#include "common/statistics/quantile.hpp"

namespace curbstone::bench::curbs::scores {

namespace {

constexpr double kBlindDisc = 4.0;     // m around the sensor, where it cannot measure the ground
constexpr double kBorderReach = 0.24;  // m around other borders

double distance(const evaluate::Place& a, const evaluate::truth::TrueCurbPoint& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

/// The nearest true point that fulfils `accept`, within `reach`; nullptr if none.
template <class Accept>
const evaluate::truth::TrueCurbPoint* nearest_truth(const std::vector<evaluate::truth::TrueCurbPoint>& truth,
                                                    const evaluate::Place& at, double reach, Accept accept) {
  const evaluate::truth::TrueCurbPoint* best = nullptr;
  double nearest = reach;
  for (const evaluate::truth::TrueCurbPoint& t : truth) {
    const double d = distance(at, t);
    if (!accept(t) || d > nearest) continue;
    best = &t;
    nearest = d;
  }
  return best;
}

void score_recall(const std::vector<evaluate::CurbFoot>& detections, const evaluate::truth::StreetLabels& truth,
                  double tolerance, double range, StreetScore& score) {
  std::array<int, kTrueStepBounds.size() + 1> total{};
  std::array<int, kTrueStepBounds.size() + 1> hit{};
  for (const evaluate::truth::TrueCurbPoint& t : truth.curbs) {
    const double r = std::hypot(t.x, t.y);
    if (t.height == 0 || r > range || r < kBlindDisc) continue;  // a border of height 0 is not a curb
    const bool found = std::any_of(detections.begin(), detections.end(),
                                   [&](const evaluate::CurbFoot& d) { return distance(d.at, t) <= tolerance; });
    const auto step = static_cast<std::size_t>(
        std::lower_bound(kTrueStepBounds.begin(), kTrueStepBounds.end(), t.height) - kTrueStepBounds.begin());
    ++total[step];
    hit[step] += found ? 1 : 0;
    if (t.dropped) continue;
    ++score.truth;
    score.found += found ? 1 : 0;
  }
  for (std::size_t k = 0; k < total.size(); ++k)
    score.by_step[k].recall = total[k] > 0 ? static_cast<double>(hit[k]) / total[k] : 0;
}

const evaluate::truth::TrueCurbPoint* true_curb(const evaluate::CurbFoot& detection,
                                                const evaluate::truth::StreetLabels& truth, double tolerance) {
  return nearest_truth(truth.curbs, detection.at, tolerance,
                       [](const evaluate::truth::TrueCurbPoint& t) { return !t.dropped; });
}

}  // namespace

Verdict judge(const evaluate::CurbFoot& detection, const evaluate::truth::StreetLabels& truth, double tolerance) {
  if (std::hypot(detection.at.x, detection.at.y) < kBlindDisc) return Verdict::kNotCounted;
  if (true_curb(detection, truth, tolerance) != nullptr) return Verdict::kRight;
  const bool border = nearest_truth(truth.curbs, detection.at, kBorderReach,
                                    [](const evaluate::truth::TrueCurbPoint& t) { return t.dropped; }) != nullptr;
  if (border) return Verdict::kNotCounted;
  const bool is_none =
      truth.border_at(detection.at.x, detection.at.y, detection.up.x, detection.up.y) == evaluate::truth::Border::kNone;
  return is_none ? Verdict::kWrong : Verdict::kNotCounted;
}

StreetScore score_street(const std::vector<evaluate::CurbFoot>& detections, const evaluate::truth::StreetLabels& truth,
                         double tolerance, double range) {
  StreetScore score;
  std::vector<double> lateral;
  for (const evaluate::CurbFoot& d : detections) {
    if (std::hypot(d.at.x, d.at.y) > range) continue;
    const Verdict verdict = judge(d, truth, tolerance);
    ++(verdict == Verdict::kNotCounted ? score.dont_care : score.detections);
    if (verdict != Verdict::kRight) continue;
    ++score.right;
    const evaluate::truth::TrueCurbPoint* t = true_curb(d, truth, tolerance);
    lateral.push_back((d.at.x - t->x) * d.up.x + (d.at.y - t->y) * d.up.y);
  }
  if (!lateral.empty()) {
    score.bias = quantile_in_place(lateral, 0.5);
    for (double& l : lateral) l = std::abs(l - score.bias);
    score.spread = 1.4826 * quantile_in_place(lateral, 0.5);
  }
  score_recall(detections, truth, tolerance, range, score);
  return score;
}

StreetScore pooled(const std::vector<StreetScore>& scores) {
  StreetScore sum;
  const auto n = static_cast<double>(scores.size());
  for (const StreetScore& s : scores) {
    sum.truth += s.truth;
    sum.found += s.found;
    sum.detections += s.detections;
    sum.right += s.right;
    sum.dont_care += s.dont_care;
    sum.bias += s.bias / n;
    sum.spread += s.spread / n;
    for (std::size_t k = 0; k < sum.by_step.size(); ++k) sum.by_step[k].recall += s.by_step[k].recall / n;
  }
  return sum;
}

}  // namespace curbstone::bench::curbs::scores
