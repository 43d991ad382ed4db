#include "tools/simulate/paint/plan_markings.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

namespace curbstone::simulate::paint {

namespace {

using world::Street;

constexpr double kLineWidth = 0.12;     // m
constexpr double kStep = 0.25;          // m between the vertices of a line
constexpr double kMinLength = 1.0;      // m of a line
constexpr double kFromCurb = 0.5;       // m, of the edge line
constexpr double kBesideParked = 2.25;  // m from the curb, of the line along parked cars
constexpr double kZebraLength = 4.0;    // m along the street
constexpr double kBar = 0.5;            // m, of a crossing's bars and of the gaps between
constexpr double kStopWidth = 0.4;      // m
constexpr double kBend = 1.0 / 40.0;    // 1/m; sharper bends have no overtaking

struct Dashes {
  double dash, gap;  // m
};

struct Interval {
  double from, to;  // m along the street
  [[nodiscard]] bool holds(double s) const { return s >= from && s <= to; }
};

/// Paints the markings along one street.
class StreetPainter {
 public:
  StreetPainter(const Street& street, const world::Ground& ground, std::vector<Marking>& markings)
      : street_(street), ground_(ground), markings_(markings) {}

  /// A line `left` m from the crown wherever `wanted`, interrupted at junctions. Two lines if `apart` > 0.
  void line(double left, const Interval& part, const std::function<bool(double)>& wanted, MarkingType type,
            Dashes dashes = {0, 0}, double apart = 0) {
    std::vector<double> run;
    const auto finish = [&] {
      if (run.size() > 1 && run.back() - run.front() >= kMinLength) add_run(left, run, type, dashes, apart);
      run.clear();
    };
    for (double s = part.from; s <= part.to; s += kStep) {
      if (wanted(s) && between_curbs(s, left)) {
        run.push_back(s);
      } else {
        finish();
      }
    }
    finish();
  }

  /// Bars along the street, across the width between the edge lines.
  void crossing(double s) {
    Marking marking{MarkingType::kCrossing, {}};
    const double reach = street_.half_width() - 0.9;
    const int bars = static_cast<int>((reach + 0.5 * kBar) / kBar);
    for (int i = 0; i < bars; ++i) {
      const double left = (i - 0.5 * (bars - 1)) * 2.0 * kBar;
      marking.pieces.push_back({{at(s - 0.5 * kZebraLength, left), at(s + 0.5 * kZebraLength, left)}, kBar});
    }
    markings_.push_back(std::move(marking));
  }

  /// Across the lane on the `side` of the crown: the right one for traffic in direction of s.
  void stop_line(double s, world::Side side) {
    const double sign = static_cast<int>(side);
    markings_.push_back(
        {MarkingType::kStopLine, {{{at(s, 0.1 * sign), at(s, sign * (street_.half_width() - 0.7))}, kStopWidth}}});
  }

  /// An arrow of 4 m from s on, for traffic in direction `way` (1 or -1 along s).
  void arrow(double s, double way) {
    const double left = -way * 0.5 * street_.half_width(), tip = s + way * 4.0;
    markings_.push_back({MarkingType::kOther,
                         {{{at(s, left), at(tip - way * 0.1, left)}, 0.16},
                          {{at(tip - way * 1.1, left - 0.4), at(tip, left)}, 0.16},
                          {{at(tip - way * 1.1, left + 0.4), at(tip, left)}, 0.16}}});
  }

  [[nodiscard]] Eigen::Vector2d at(double s, double left) const {
    const Street::Sample sample = street_.at(s);
    return sample.point + left * sample.normal();
  }
  [[nodiscard]] double curvature(double s) const {
    constexpr double kHalf = 3.0;
    return (street_.at(s + kHalf).tangent - street_.at(s - kHalf).tangent).norm() / (2.0 * kHalf);
  }
  /// Whether the nearest curb is the street's own: not at a junction, nor outside the world.
  [[nodiscard]] bool between_curbs(double s, double left) const {
    const Eigen::Vector2d p = at(s, left);
    if (!ground_.inside(p.x(), p.y())) return false;
    const auto distance =
        static_cast<double>(ground_.at(static_cast<float>(p.x()), static_cast<float>(p.y())).distance);
    return std::abs(distance + street_.half_width() - std::abs(left)) < 0.2;
  }
  [[nodiscard]] bool clear_street(const Interval& part) const {
    for (double s = part.from; s <= part.to; s += 0.5) {
      for (const double left : {-0.8, 0.0, 0.8}) {
        if (!between_curbs(s, left * street_.half_width())) return false;
      }
    }
    return true;
  }
  /// Whether another street continues `beyond` m after s.
  [[nodiscard]] bool meets_street(double s, double beyond) const {
    const Street::Sample end = street_.at(s);
    const Eigen::Vector2d p = end.point + beyond * end.tangent;
    return ground_.inside(p.x(), p.y()) &&
           ground_.at(static_cast<float>(p.x()), static_cast<float>(p.y())).distance < -1.0F;
  }

 private:
  [[nodiscard]] MarkingPiece piece(double left, double from, double to) const {
    MarkingPiece piece{{}, kLineWidth};
    const int n = std::max(1, static_cast<int>(std::lround((to - from) / kStep)));
    for (int i = 0; i <= n; ++i) piece.centre.push_back(at(from + (to - from) * i / n, left));
    return piece;
  }
  void add_run(double left, const std::vector<double>& run, MarkingType type, Dashes dashes, double apart) {
    Marking marking{type, {}};
    const double from = run.front(), to = run.back();
    if (type == MarkingType::kDashed) {
      for (double s = from; s + 0.5 <= to; s += dashes.dash + dashes.gap)
        marking.pieces.push_back(piece(left, s, std::min(s + dashes.dash, to)));
    } else if (type == MarkingType::kDouble) {
      for (const double side : {-0.5, 0.5}) marking.pieces.push_back(piece(left + side * apart, from, to));
    } else {
      marking.pieces.push_back(piece(left, from, to));
    }
    markings_.push_back(std::move(marking));
  }

  const Street& street_;
  const world::Ground& ground_;
  std::vector<Marking>& markings_;
};

bool in_one_of(const std::vector<Interval>& parts, double s) {
  return std::any_of(parts.begin(), parts.end(), [&](const Interval& part) { return part.holds(s); });
}

/// The lines of one stretch.
void paint_stretch(StreetPainter& painter, const Street& street, const Interval& part,
                   const std::vector<Interval>& crossings, numerics::Random random) {
  constexpr double kBefore = 12.0;  // m of solid line before a crossing
  const bool centre = random.chance(0.85), doubled = random.chance(0.5);
  const Dashes dashes = random.chance(0.7) ? Dashes{3, 6} : Dashes{2, 3};
  const auto free = [&](double s) { return !in_one_of(crossings, s); };
  const auto no_overtaking = [&](double s) {
    return painter.curvature(s) > kBend || !free(s - kBefore) || !free(s + kBefore) || !free(s - 0.5 * kBefore) ||
           !free(s + 0.5 * kBefore);
  };
  if (centre) {
    painter.line(
        0, part, [&](double s) { return free(s) && !no_overtaking(s); }, MarkingType::kDashed, dashes);
    painter.line(
        0, part, [&](double s) { return free(s) && no_overtaking(s); },
        doubled ? MarkingType::kDouble : MarkingType::kSolid, {}, 2.0 * kLineWidth);
  }
  for (const double side : {-1.0, 1.0}) {
    const double kind = random.uniform();
    if (kind > 0.75) continue;
    const double from_curb = kind < 0.5 ? kFromCurb : kBesideParked;
    painter.line(
        side * (street.half_width() - from_curb), part, [&](double s) { return free(s) || kind < 0.5; },
        MarkingType::kSolid);
  }
}

void paint_main_street(const world::Town& town, numerics::Random random, std::vector<Marking>& markings) {
  const Street& street = town.streets.front();
  StreetPainter painter(street, town.scene->ground(), markings);
  std::vector<Interval> crossings;
  for (double s = random.uniform(20.0, 50.0); s < street.length() - 10.0; s += random.uniform(80.0, 130.0)) {
    // The next place without a junction or a bend.
    double where = s;
    while (where < s + 40.0 && (!painter.clear_street({where - 8.0, where + 8.0}) || painter.curvature(where) > kBend))
      where += 1.0;
    const bool stops = random.chance(0.5);
    if (where >= s + 40.0 || where > street.length() - 10.0) continue;
    painter.crossing(where);
    const double half = 0.5 * kZebraLength;
    if (stops) {
      painter.stop_line(where - half - 1.2, world::Side::kRight);
      painter.stop_line(where + half + 1.2, world::Side::kLeft);
    }
    const double clear = half + (stops ? 1.8 : 0.6);
    crossings.push_back({where - clear, where + clear});
  }
  const int stretches = std::max(1, static_cast<int>(street.length() / 75.0));
  for (int i = 0; i < stretches; ++i) {
    const double stretch = street.length() / stretches;
    paint_stretch(painter, street, {i * stretch, (i + 1) * stretch}, crossings,
                  random.fork(static_cast<std::uint64_t>(i)));
  }
}

/// Markings at the end of a street that leads into another, `way` along s towards it (1 or -1).
double paint_mouth(StreetPainter& painter, double end, double way, numerics::Random random) {
  constexpr double kCornerEnds = 7.5;  // m before the other street's edge
  const bool crossing = random.chance(0.4), arrow = random.chance(0.5);
  if (!random.chance(0.8)) return kCornerEnds;
  double back = kCornerEnds;
  if (crossing) {
    painter.crossing(end - way * (back + 0.5 * kZebraLength));
    back += kZebraLength + 1.2;
  }
  painter.stop_line(end - way * back, way > 0 ? world::Side::kRight : world::Side::kLeft);
  if (arrow) painter.arrow(end - way * (back + 6.5), way);
  return back + 0.4;
}

void paint_side_street(const world::Town& town, const Street& street, numerics::Random random,
                       std::vector<Marking>& markings) {
  StreetPainter painter(street, town.scene->ground(), markings);
  double from = 0, to = street.length();
  if (painter.meets_street(0, -2.0)) from = paint_mouth(painter, 0, -1.0, random.fork(1));
  if (to > 40.0 && painter.meets_street(to, 2.0)) to -= paint_mouth(painter, to, 1.0, random.fork(2));
  if (!random.chance(0.6)) return;
  const Dashes dashes = random.chance(0.7) ? Dashes{3, 6} : Dashes{2, 3};
  painter.line(
      0, {from, to}, [](double) { return true; }, MarkingType::kDashed, dashes);
}

}  // namespace

const char* name_of(MarkingType type) {
  switch (type) {
    case MarkingType::kSolid:
      return "solid";
    case MarkingType::kDashed:
      return "dashed";
    case MarkingType::kDouble:
      return "double";
    case MarkingType::kStopLine:
      return "stop_line";
    case MarkingType::kCrossing:
      return "crossing";
    case MarkingType::kOther:
      break;
  }
  return "other";
}

std::vector<Marking> plan_markings(const world::Town& town, numerics::Random random) {
  std::vector<Marking> markings;
  paint_main_street(town, random.fork(0), markings);
  for (std::size_t i = 1; i < town.streets.size(); ++i)
    paint_side_street(town, town.streets[i], random.fork(i), markings);
  // Nothing outside the world, where no ray reaches.
  const world::Ground& ground = town.scene->ground();
  std::erase_if(markings, [&](const Marking& marking) {
    return std::any_of(marking.pieces.begin(), marking.pieces.end(), [&](const MarkingPiece& piece) {
      return std::any_of(piece.centre.begin(), piece.centre.end(),
                         [&](const Eigen::Vector2d& p) { return !ground.inside(p.x(), p.y()); });
    });
  });
  return markings;
}

}  // namespace curbstone::simulate::paint
