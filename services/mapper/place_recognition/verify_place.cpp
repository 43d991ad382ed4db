#include "services/mapper/place_recognition/verify_place.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curbstone::mapper::place_recognition {
namespace {

// Measured with bench_places: at their true place, scans of towns and of KITTI score 0.91 to 0.99 with a conflict of
// 0.07 to 0.28; elsewhere 0.66 at best, with 0.38 at least. Between plain walls a wrong pose can score 0.91, but then
// it scores hardly less a metre further along.
constexpr double kMinScore = 0.80;
constexpr double kMaxConflict = 0.34;
constexpr double kMinContrast = 0.65;
constexpr double kMinInliers = 0.7;
constexpr double kMinOverlap = 0.25;
// Of a part: 12 to 18 m beyond the end of their maps, scans of two towns scored 0.67 to 0.78 with a conflict of 0.04 to
// 0.07, an overlap of 0.34 to 0.50 and 0.94 of inliers or more. Of 1207 searches for scans of elsewhere none finds a
// place (bench_places part=1, also with half=1 and global=1).
constexpr double kMinScoreOfPart = 0.65;
constexpr double kMaxConflictOfPart = 0.15;
constexpr double kMinInliersOfPart = 0.85;
constexpr double kMinOverlapOfPart = 0.3;
constexpr double kMinLeadOfPart = 0.35;   // of its score, over the runner-up
constexpr double kMaxRise = 0.15;         // m
constexpr double kMaxResidual = 0.10;     // m
constexpr double kWorthATry = 0.25;       // largest deficit of score before registration, against the best
constexpr double kMinSearchRadius = 4.0;  // m: the rivals within it are searched in any case
constexpr double kSlack = 0.5;            // m by which registration may end beyond the guess
constexpr double kTurnedSlack = 0.05;     // rad
constexpr int kMaxHypotheses = 4;         // within one guess
constexpr std::size_t kMaxTries = 4;      // registrations
constexpr double kApart = 1.0;            // m, poses that are not the same place
constexpr double kTurnedApart = 0.1;      // rad
constexpr int kCandidates = 40;           // of the index
constexpr std::size_t kMaxPlaces = 12;    // of the candidates' that are searched
constexpr double kPlaceReach = 7.0;       // m, about a candidate
constexpr double kPlaceTurn = 0.2;        // rad

/// A hypothesis, and the search that it comes from.
struct Try {
  CandidateSearch* search;
  PlaceHypothesis hypothesis;
};

bool apart(const Pose& a, const Pose& b) {
  const Pose between = a.inverse() * b;
  return between.translation().norm() > kApart || angle_of(between) > kTurnedApart;
}

/// The share of what the runner-up leaves unexplained that the match explains.
double contrast(const PlaceMatch& match) {
  return (match.score - match.runner_up) / std::max(1 - match.runner_up, 0.01);
}

bool fits_whole(const PlaceMatch& match) {
  const registration::RegistrationResult& r = match.registration;
  return contrast(match) >= kMinContrast && r.overlap >= kMinOverlap && r.inlier_ratio >= kMinInliers &&
         match.score >= kMinScore && match.conflict <= kMaxConflict;
}

bool fits_in_part(const PlaceMatch& match) {
  const registration::RegistrationResult& r = match.registration;
  return match.score - match.runner_up >= kMinLeadOfPart * match.score && r.overlap >= kMinOverlapOfPart &&
         r.inlier_ratio >= kMinInliersOfPart && match.score >= kMinScoreOfPart && match.conflict <= kMaxConflictOfPart;
}

bool is_place(const PlaceMatch& match, Known known) {
  const registration::RegistrationResult& r = match.registration;
  return r.converged && (r.degenerate & registration::kPlanarAxes) == 0 && r.residual <= kMaxResidual &&
         std::abs(match.rise) <= kMaxRise && (fits_whole(match) || (known == Known::kPart && fits_in_part(match)));
}

bool within(const PlaceGuess& guess, const Pose& T_map_base) {
  const Eigen::Vector3d off = T_map_base.translation() - guess.T_map_base.translation();
  const double turn = roll_pitch_yaw(guess.T_map_base.linear().transpose() * T_map_base.linear()).z();
  return off.head<2>().cwiseAbs().maxCoeff() <= guess.reach + kSlack && std::abs(turn) <= guess.turn + kTurnedSlack;
}

/// Registers the best hypothesis, and others that may be as good.
std::optional<PlaceMatch> decide(const std::vector<scan::LidarPoint>& points, std::vector<Try> tries, Known known) {
  if (tries.empty()) return std::nullopt;
  std::stable_sort(tries.begin(), tries.end(),
                   [](const Try& a, const Try& b) { return a.hypothesis.score > b.hypothesis.score; });
  std::vector<PlaceMatch> matches;
  for (const Try& t : tries) {
    if (matches.size() == kMaxTries || t.hypothesis.score < tries.front().hypothesis.score - kWorthATry) break;
    matches.push_back(t.search->refine(points, t.hypothesis));
  }
  PlaceMatch best =
      *std::max_element(matches.begin(), matches.end(), [](const auto& a, const auto& b) { return a.score < b.score; });
  for (const PlaceMatch& other : matches) {
    if (apart(other.registration.T_map_base, best.registration.T_map_base))
      best.runner_up = std::max(best.runner_up, other.score);
  }
  // Hypotheses beyond the limit of tries count with their score before registration.
  for (std::size_t i = matches.size(); i < tries.size(); ++i) {
    if (apart(tries[i].hypothesis.T_map_base, best.registration.T_map_base))
      best.runner_up = std::max(best.runner_up, tries[i].hypothesis.score);
  }
  if (!is_place(best, known)) return std::nullopt;
  return best;
}

}  // namespace

std::optional<PlaceMatch> verify_place(const std::vector<scan::LidarPoint>& points, const PlaceGuess& guess,
                                       const std::vector<const scan::Keyframe*>& nodes, const config::IcpConfig& config,
                                       const Eigen::Vector3d& lidar, Known known) {
  PlaceGuess wide = guess;
  wide.reach = std::max(guess.reach, kMinSearchRadius);
  CandidateSearch search(nodes, wide, config, lidar);
  std::vector<Try> tries;
  for (const PlaceHypothesis& hypothesis : search.hypotheses(points, kMaxHypotheses))
    tries.push_back({&search, hypothesis});
  const std::optional<PlaceMatch> match = decide(points, tries, known);
  return match && within(guess, match->registration.T_map_base) ? match : std::nullopt;
}

std::optional<PlaceMatch> verify_place(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base,
                                       const ScanContext& index, const std::vector<const scan::Keyframe*>& nodes,
                                       const config::IcpConfig& config, const Eigen::Vector3d& lidar, Known known) {
  std::vector<scan::KeyframePoint> scan;
  for (const scan::LidarPoint& point : points) {
    if (const auto packed = scan::pack(point.position)) scan.push_back(*packed);
  }
  const Eigen::Vector3d rpy = roll_pitch_yaw(T_map_base.linear());
  std::vector<PlaceGuess> guesses;
  for (const PlaceCandidate& candidate : index.query(scan, kCandidates)) {
    if (candidate.node < 0 || static_cast<std::size_t>(candidate.node) >= nodes.size()) continue;
    const Pose& T = nodes[static_cast<std::size_t>(candidate.node)]->T_map_base;
    PlaceGuess guess{T, kPlaceReach, kPlaceTurn};
    guess.T_map_base.linear() = rotation_from_rpy(rpy.x(), rpy.y(), roll_pitch_yaw(T.linear()).z() + candidate.yaw);
    const bool known = std::any_of(guesses.begin(), guesses.end(), [&](const PlaceGuess& other) {
      const Pose off = other.T_map_base.inverse() * guess.T_map_base;
      return off.translation().norm() < 0.7 * kPlaceReach && std::abs(roll_pitch_yaw(off.linear()).z()) < kPlaceTurn;
    });
    if (!known && guesses.size() < kMaxPlaces) guesses.push_back(guess);
  }
  std::vector<std::unique_ptr<CandidateSearch>> searches;
  std::vector<Try> tries;
  for (const PlaceGuess& guess : guesses) {
    searches.push_back(std::make_unique<CandidateSearch>(nodes, guess, config, lidar));
    for (const PlaceHypothesis& hypothesis : searches.back()->hypotheses(points, 2))
      tries.push_back({searches.back().get(), hypothesis});
  }
  return decide(points, tries, known);
}

}  // namespace curbstone::mapper::place_recognition
