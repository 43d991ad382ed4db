#pragma once

#include <vector>

#include "services/semantic_map/marking_lines/piece_sequences.hpp"
#include "services/semantic_map/marking_lines/sequence_gaps.hpp"
#include "services/semantic_map/tile/driven_path.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::marking_lines {

/// A part of a sequence that is one line.
struct TypedSequence {
  PieceSequence pieces;
  tile::MarkingType type = tile::MarkingType::kUnknown;
};

/// Types a sequence, and cuts it where a solid line meets a dashed one. A gap is evidence of dashes only if dark ground
/// was seen in it, because paint may continue where nothing was seen. `path`: as driven, m in map; a stop line lies
/// across it.
[[nodiscard]] std::vector<TypedSequence> type_sequence(const PieceSequence& sequence, const tile::DrivenPath& path,
                                                       const SeenGround& is_seen);

}  // namespace curbstone::semantic_map::marking_lines
