#include "services/semantic_map/marking_lines/marking_lines.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "services/semantic_map/marking_lines/crossings.hpp"
#include "services/semantic_map/marking_lines/line_types.hpp"
#include "services/semantic_map/marking_lines/marking_chains.hpp"
#include "services/semantic_map/marking_lines/marking_pieces.hpp"
#include "services/semantic_map/marking_lines/piece_sequences.hpp"

namespace curbstone::semantic_map::marking_lines {
namespace {

constexpr double kMinLoneLength = 0.8;  // m
constexpr double kSameLine = 0.3;       // m, largest distance from the earlier line

TileKey place_of(const tile::MarkingVertex& v) {
  return {static_cast<std::int32_t>(std::floor(double{v.x} / kSameLine)),
          static_cast<std::int32_t>(std::floor(double{v.y} / kSameLine))};
}

}  // namespace

std::vector<tile::MarkingLine> link_marking_cells(const std::vector<MapMarkingCell>& cells,
                                                  const tile::DrivenPath& path,
                                                  const markings::MarkingParameters& parameters,
                                                  const SeenGround& is_seen) {
  const MarkingField field(cells);
  std::vector<MarkingPiece> pieces;
  for (const MarkingChain& chain : chain_markings(field, {parameters.vote})) {
    auto piece = measure_piece(field, chain);
    if (piece && is_paint(*piece, parameters)) pieces.push_back(std::move(*piece));
  }
  const std::vector<tile::MarkingLine> crossings = extract_crossings(pieces);
  std::vector<tile::MarkingLine> lines = crossings;
  for (const PieceSequence& sequence : join_pieces(pieces, crossings)) {
    for (const TypedSequence& part : type_sequence(sequence, path, is_seen)) {
      if (part.pieces.size() == 1 && part.pieces.front().length() < kMinLoneLength) continue;
      lines.push_back(line_of(part.pieces, part.type));
    }
  }
  for (std::size_t i = 0; i < lines.size(); ++i) lines[i].id = static_cast<std::int32_t>(i);
  return lines;
}

void MarkingLineIds::assign(std::vector<tile::MarkingLine>& lines) {
  std::map<TileKey, std::int32_t> before;
  for (const tile::MarkingLine& line : before_) {
    for (const tile::MarkingVertex& v : line.points) before.try_emplace(place_of(v), line.id);
  }
  std::set<std::int32_t> taken;
  for (tile::MarkingLine& line : lines) {
    std::map<std::int32_t, int> votes;
    for (const tile::MarkingVertex& v : line.points) {
      if (const auto it = before.find(place_of(v)); it != before.end()) ++votes[it->second];
    }
    const auto best =
        std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    line.id = best != votes.end() && !taken.contains(best->first) ? best->first : next_++;
    taken.insert(line.id);
  }
  before_ = lines;
}

}  // namespace curbstone::semantic_map::marking_lines
