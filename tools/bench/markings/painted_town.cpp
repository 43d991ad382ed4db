#include "tools/bench/markings/painted_town.hpp"

#include "tools/bench/curbs/scenes/drive_tiles.hpp"
#include "tools/simulate/town_setup.hpp"

namespace curbstone::bench::markings {
namespace {

semantic_map::tile::MarkingType type_of(simulate::paint::MarkingType type) {
  using From = simulate::paint::MarkingType;
  using To = semantic_map::tile::MarkingType;
  switch (type) {
    case From::kSolid:
    case From::kDouble:
      return To::kSolid;
    case From::kDashed:
      return To::kDashed;
    case From::kStopLine:
      return To::kStopLine;
    case From::kCrossing:
      return To::kCrossing;
    case From::kOther:
      break;
  }
  return To::kOther;
}

}  // namespace

PaintedTown drive_painted_town(std::uint64_t seed, double seconds, simulate::paint::Paint paint, bool ring_gains) {
  simulate::TownTour tour;
  tour.seed = seed;
  tour.seconds = seconds;
  simulate::rig::SimulateConfig config;
  config.paint = paint;
  config.intensity.ring_gains = ring_gains;
  constexpr std::int64_t kStart = 1'700'000'000'000'000;  // us
  const simulate::TownSetup setup(tour, kStart, config);
  PaintedTown town{curbs::scenes::drive_tiles(setup.drive()), curbs::scenes::true_trajectory(setup.drive()), {}};
  for (const simulate::paint::Marking& marking : setup.ground().markings()) {
    TrueLine line{type_of(marking.type), {}};
    for (const auto& piece : marking.pieces) line.pieces.push_back({piece.centre, piece.width});
    if (marking.type == simulate::paint::MarkingType::kDouble && marking.pieces.size() == 2) {
      const auto& a = marking.pieces[0].centre;
      const auto& b = marking.pieces[1].centre;
      for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) line.middle.push_back(0.5 * (a[i] + b[i]));
    }
    town.lines.push_back(std::move(line));
  }
  return town;
}

}  // namespace curbstone::bench::markings
