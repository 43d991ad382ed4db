#include "services/semantic_map/marking_lines/piece_sequences.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "common/statistics/quantile.hpp"
#include "common/tiles/tile.hpp"
#include "services/semantic_map/curb_lines/joints.hpp"

namespace curbstone::semantic_map::marking_lines {
namespace {

using curb_lines::Joint;
using curb_lines::kFree;
using curb_lines::SmoothingSpline;
using tile::MarkingType;

constexpr double kMaxJoinedGap = 9.0;  // m
constexpr double kGapOfLength = 4.0;   // longest gap, in lengths of the shorter piece
constexpr double kOffEnd = 0.12;       // m off each other's line, plus a share of the gap
constexpr double kOffEndShare = 0.06;
constexpr double kAlikeEnds = 0.94;  // cosine between an end's direction and the way across
constexpr double kWidthAlike = 2.2;
constexpr double kVertexSpacing = 0.20;  // m between vertices
constexpr double kGapSpacing = 1.0;      // m between vertices where there is no paint

// Ends of pieces are numbered as in joints.hpp.
bool is_first(std::size_t end) {
  return end == curb_lines::first_end(curb_lines::piece_of(end));
}
const MarkingPiece& piece_at(const std::vector<MarkingPiece>& pieces, std::size_t end) {
  return pieces[curb_lines::piece_of(end)];
}
const Eigen::Vector2d& at(const std::vector<MarkingPiece>& pieces, std::size_t end) {
  return is_first(end) ? piece_at(pieces, end).begin_at : piece_at(pieces, end).end_at;
}
const Eigen::Vector2d& out(const std::vector<MarkingPiece>& pieces, std::size_t end) {
  return is_first(end) ? piece_at(pieces, end).begin_direction : piece_at(pieces, end).end_direction;
}

/// Distance of two ends, if each points at the other; otherwise infinity.
double gap_between(const std::vector<MarkingPiece>& pieces, std::size_t a, std::size_t b) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const MarkingPiece& p = piece_at(pieces, a);
  const MarkingPiece& q = piece_at(pieces, b);
  const Eigen::Vector2d d = at(pieces, b) - at(pieces, a);
  const double gap = d.norm();
  if (gap > std::min(kMaxJoinedGap, kGapOfLength * std::min(p.length(), q.length()))) return kNone;
  if (std::max(p.width, q.width) > kWidthAlike * std::min(p.width, q.width)) return kNone;
  const Eigen::Vector2d& from = out(pieces, a);
  const Eigen::Vector2d& to = out(pieces, b);
  if (-from.dot(to) < kAlikeEnds) return kNone;
  if (d.dot(from) < -0.1 || d.dot(to) > 0.1) return kNone;
  const auto off = [&](const Eigen::Vector2d& direction) {
    return std::abs(d.x() * direction.y() - d.y() * direction.x());
  };
  if (std::max(off(from), off(to)) > kOffEnd + kOffEndShare * gap + gap * (1 - kAlikeEnds)) return kNone;
  return gap;
}

MarkingPiece reversed(MarkingPiece piece) {
  const double last = piece.samples.back().s;
  std::reverse(piece.samples.begin(), piece.samples.end());
  for (auto& sample : piece.samples) sample.s = last - sample.s;
  std::swap(piece.begin_at, piece.end_at);
  std::swap(piece.begin_direction, piece.end_direction);
  std::tie(piece.begin, piece.end) = std::tuple(last - piece.end, last - piece.begin);
  return piece;
}

/// Whether the segment from a to b crosses the bars of a crossing.
bool is_across(const tile::MarkingLine& crossing, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const auto place = [](const tile::MarkingVertex& v) { return Eigen::Vector2d(double{v.x}, double{v.y}); };
  const auto side = [](const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Eigen::Vector2d& at) {
    const Eigen::Vector2d way = to - from;
    const Eigen::Vector2d d = at - from;
    return way.x() * d.y() - way.y() * d.x();
  };
  const Eigen::Vector2d first = place(crossing.points.front());
  const Eigen::Vector2d last = place(crossing.points.back());
  return side(first, last, a) * side(first, last, b) < 0 && side(a, b, first) * side(a, b, last) < 0;
}

/// All pairs of ends that point at each other.
std::vector<Joint> find_joints(const std::vector<MarkingPiece>& pieces,
                               const std::vector<tile::MarkingLine>& crossings) {
  const auto square = [&](std::size_t end) {
    const Eigen::Vector2d& p = at(pieces, end);
    return TileKey{static_cast<std::int32_t>(std::floor(p.x() / kMaxJoinedGap)),
                   static_cast<std::int32_t>(std::floor(p.y() / kMaxJoinedGap))};
  };
  std::unordered_map<TileKey, std::vector<std::size_t>, TileKeyHash> grid;
  for (std::size_t end = 0; end < 2 * pieces.size(); ++end) grid[square(end)].push_back(end);
  std::vector<Joint> joints;
  const auto try_square = [&](std::size_t a, TileKey key) {
    const auto it = grid.find(key);
    if (it == grid.end()) return;
    for (const std::size_t b : it->second) {
      if (b <= a || curb_lines::piece_of(a) == curb_lines::piece_of(b)) continue;
      const double gap = gap_between(pieces, a, b);
      const bool is_open = std::isfinite(gap) && std::none_of(crossings.begin(), crossings.end(), [&](const auto& c) {
                             return is_across(c, at(pieces, a), at(pieces, b));
                           });
      if (is_open) joints.push_back({gap, a, b});
    }
  };
  for (std::size_t a = 0; a < 2 * pieces.size(); ++a) {
    const TileKey centre = square(a);
    for (std::int32_t x = centre.x - 1; x <= centre.x + 1; ++x) {
      for (std::int32_t y = centre.y - 1; y <= centre.y + 1; ++y) try_square(a, {x, y});
    }
  }
  return joints;
}

/// Follows joints from a free end, each piece in the direction in which it is entered.
PieceSequence follow(std::size_t end, const std::vector<MarkingPiece>& pieces,
                     const std::vector<std::size_t>& partner) {
  PieceSequence sequence;
  for (; end != kFree; end = partner[curb_lines::opposite(end)])
    sequence.push_back(is_first(end) ? piece_at(pieces, end) : reversed(piece_at(pieces, end)));
  return sequence;
}

/// Begin and end of the paint along a sequence, m, piece by piece, and the samples of all pieces.
struct LaidOutSequence {
  struct Painted {
    double begin, end;
  };
  std::vector<Painted> painted;
  std::vector<SmoothingSpline::Sample> samples;
};

LaidOutSequence lay_out(const PieceSequence& sequence) {
  LaidOutSequence laid;
  double offset = 0;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    const MarkingPiece& piece = sequence[k];
    if (k > 0) offset = laid.painted.back().end + (piece.begin_at - sequence[k - 1].end_at).norm() - piece.begin;
    laid.painted.push_back({offset + piece.begin, offset + piece.end});
    for (SmoothingSpline::Sample sample : piece.samples) {
      sample.s += offset;
      laid.samples.push_back(sample);
    }
  }
  return laid;
}

/// Vertices along the spline: dense on paint, sparse in gaps.
std::vector<tile::MarkingVertex> vertices_of(const SmoothingSpline& spline,
                                             const std::vector<LaidOutSequence::Painted>& painted) {
  std::vector<tile::MarkingVertex> vertices;
  const auto add = [&](double s, bool is_painted) {
    // Beyond the samples a line is extended straight.
    const double inside = std::clamp(s, spline.begin(), spline.end());
    const SmoothingSpline::Values values = spline.at(inside);
    const Eigen::Vector2d along = spline.derivative(inside).head<2>().normalized();
    vertices.push_back(vertex(values.head<2>() + (s - inside) * along, values.z(), is_painted));
  };
  const auto add_between = [&](double from, double to, double spacing, bool is_painted, bool with_end) {
    const int steps = std::max(1, static_cast<int>(std::ceil((to - from) / spacing - 1e-9)));
    for (int i = 0; i < steps + (with_end ? 1 : 0); ++i) add(from + (to - from) * i / steps, is_painted && i < steps);
  };
  for (std::size_t k = 0; k < painted.size(); ++k) {
    const bool is_last = k + 1 == painted.size();
    add_between(painted[k].begin, painted[k].end, kVertexSpacing, true, is_last);
    if (!is_last) add_between(painted[k].end, painted[k + 1].begin, kGapSpacing, false, false);
  }
  return vertices;
}

}  // namespace

double median_of(std::vector<double> values) {
  return quantile_or(std::move(values), 0.5, 0);
}

tile::MarkingVertex vertex(const Eigen::Vector2d& at, double z, bool painted) {
  return {static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(z), painted};
}

float confidence_of(double contrast, float length) {
  constexpr double kHalf = 15;  // contrast of what is as likely a patch of another asphalt
  const double squared = contrast * contrast;
  return static_cast<float>(squared / (squared + kHalf * kHalf) * (1 - std::exp(-double{length})));
}

std::vector<PieceSequence> join_pieces(const std::vector<MarkingPiece>& pieces,
                                       const std::vector<tile::MarkingLine>& crossings) {
  const std::vector<std::size_t> partner =
      curb_lines::join_shortest_first(pieces.size(), find_joints(pieces, crossings));
  std::vector<PieceSequence> sequences;
  std::vector<bool> is_used(pieces.size());
  for (std::size_t end = 0; end < 2 * pieces.size(); ++end) {
    if (partner[end] != kFree || is_used[curb_lines::piece_of(end)]) continue;
    for (std::size_t on = end; on != kFree; on = partner[curb_lines::opposite(on)])
      is_used[curb_lines::piece_of(on)] = true;
    sequences.push_back(follow(end, pieces, partner));
  }
  return sequences;
}

PieceSequence reversed(const PieceSequence& sequence) {
  PieceSequence backwards;
  for (auto piece = sequence.rbegin(); piece != sequence.rend(); ++piece) backwards.push_back(reversed(*piece));
  return backwards;
}

std::pair<MarkingPiece, MarkingPiece> split(const MarkingPiece& piece, double at) {
  constexpr double kArm = 1.0;  // m that say where the line leads
  const auto& samples = piece.samples;
  const auto place = [&](double s) -> Eigen::Vector2d {
    const double inside = std::clamp(s, samples.front().s, samples.back().s);
    const auto next = std::lower_bound(samples.begin() + 1, samples.end() - 1, inside,
                                       [](const auto& sample, double s_) { return sample.s < s_; });
    const auto last = next - 1;
    const double share = (inside - last->s) / std::max(next->s - last->s, 1e-9);
    return (last->values + share * (next->values - last->values)).head<2>();
  };
  const auto is_behind = [&](const auto& sample) { return sample.s > at; };
  const auto cut = std::find_if(samples.begin(), samples.end(), is_behind);
  std::pair<MarkingPiece, MarkingPiece> parts(piece, piece);
  auto& [before, behind] = parts;
  before.samples.assign(samples.begin(), cut);
  behind.samples.assign(cut, samples.end());
  before.end = at;
  before.end_at = behind.begin_at = place(at);
  before.end_direction = (place(at) - place(at - kArm)).normalized();
  behind.begin_direction = (place(at) - place(at + kArm)).normalized();
  const double offset = cut == samples.end() ? at : cut->s;
  for (auto& sample : behind.samples) sample.s -= offset;
  behind.begin = at - offset;
  behind.end = piece.end - offset;
  return parts;
}

tile::MarkingLine line_of(const PieceSequence& sequence, tile::MarkingType type) {
  const auto [painted, samples] = lay_out(sequence);
  std::vector<double> dashes;
  std::vector<double> gaps;
  std::vector<double> widths;
  double contrast = 0;
  double length = 0;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    dashes.push_back(painted[k].end - painted[k].begin);
    if (k + 1 < sequence.size()) gaps.push_back(painted[k + 1].begin - painted[k].end);
    widths.push_back(sequence[k].width);
    contrast += sequence[k].contrast * sequence[k].length();
    length += sequence[k].length();
  }
  tile::MarkingLine line;
  line.points = vertices_of(SmoothingSpline(samples), painted);
  line.type = type;
  line.width = static_cast<float>(median_of(widths));
  if (line.type == MarkingType::kDashed) {
    line.dash = static_cast<float>(median_of(dashes));
    line.gap = static_cast<float>(median_of(gaps));
  }
  line.confidence = confidence_of(contrast / length, static_cast<float>(length));
  return line;
}

}  // namespace curbstone::semantic_map::marking_lines
