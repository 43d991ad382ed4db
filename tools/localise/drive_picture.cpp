#include "tools/localise/drive_picture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/linear/decompositions.hpp"
#include "services/semantic_map/picture/map_picture.hpp"
#include "services/semantic_map/picture/png_file.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "tools/stored_picture/stored_picture.hpp"

namespace curbstone::localise {
namespace {

using semantic_map::picture::Colour;
using semantic_map::picture::PictureLine;

constexpr Colour kKnown{0, 90, 255}, kLost{255, 140, 0}, kEllipse{150, 0, 200};
constexpr double kBetweenEllipses = 5.0;  // m
constexpr double kSigmas = 3.0;
constexpr double kTimes = 20.0;     // magnification: ellipses of centimetres would not be visible
constexpr double kUnknown = 100.0;  // m, 1 sigma: the pose is still unknown
constexpr double kMaxJump = 5.0;    // m; a jump from a guess to the localised pose is not drawn

Eigen::Vector2d position(const map_pose_t& pose) {
  return {pose.map_base_position[0], pose.map_base_position[1]};
}

bool is_lost(const map_pose_t& pose) {
  return (pose.flags & map_pose_t::LOST) != 0;
}

PictureLine ellipse(const map_pose_t& pose) {
  Eigen::Matrix2d covariance;
  covariance << static_cast<double>(pose.covariance[0]), static_cast<double>(pose.covariance[1]),
      static_cast<double>(pose.covariance[6]), static_cast<double>(pose.covariance[7]);
  const auto [values, axes] = eigen_pairs<2>(covariance);
  const Eigen::Vector2d sigmas = values.cwiseMax(0).cwiseSqrt();
  PictureLine line{{}, kEllipse, 1.5};
  for (int i = 0; i <= 24; ++i) {
    const double a = 2 * std::numbers::pi * i / 24;
    const Eigen::Vector2d unit(std::cos(a), std::sin(a));
    line.points.push_back(position(pose) + kTimes * kSigmas * axes * sigmas.cwiseProduct(unit));
  }
  return line;
}

/// The path in pieces of one colour each, with ellipses at intervals.
std::vector<PictureLine> overlays_of(const std::vector<map_pose_t>& poses) {
  std::vector<PictureLine> lines, ellipses;
  double since_ellipse = kBetweenEllipses;
  const map_pose_t* last = nullptr;
  for (const map_pose_t& pose : poses) {
    if (!(std::sqrt(static_cast<double>(pose.covariance[0])) < kUnknown)) continue;
    const double step = last == nullptr ? 0 : (position(pose) - position(*last)).norm();
    const Colour colour = is_lost(pose) ? kLost : kKnown;
    if (last == nullptr || step > kMaxJump || is_lost(pose) != is_lost(*last)) {
      lines.push_back({{}, colour, 2.5});
      if (last != nullptr && step <= kMaxJump) lines.back().points.push_back(position(*last));
    }
    lines.back().points.push_back(position(pose));
    since_ellipse += step;
    if (!is_lost(pose) && since_ellipse >= kBetweenEllipses) {
      ellipses.push_back(ellipse(pose));
      since_ellipse = 0;
    }
    last = &pose;
  }
  std::stable_partition(lines.begin(), lines.end(), [](const PictureLine& line) { return line.colour == kKnown; });
  lines.insert(lines.end(), ellipses.begin(), ellipses.end());
  return lines;
}

}  // namespace

void draw_drive(const std::string& map, const std::vector<map_pose_t>& poses, const std::string& png) {
  const semantic_map::store::MapReader reader(map);
  semantic_map::picture::MapPicture picture = output::stored_picture(reader);
  picture.overlays = overlays_of(poses);
  picture.overlays_are = "placed";
  semantic_map::picture::PictureOptions options;
  options.title = "orange: lost; violet: 3 sigma, 20 times as wide";
  write_png(draw_map(picture, options), png);
}

}  // namespace curbstone::localise
