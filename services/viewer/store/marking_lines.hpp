#pragma once

#include <cstddef>
#include <curbstone/marking_lines_t.hpp>

#include "services/viewer/store/boxed_lines.hpp"

namespace curbstone {

// What BoxedLines requires of a line.
[[nodiscard]] bool is_sound(const marking_line_t& line);
[[nodiscard]] bool is_same(const marking_line_t& a, const marking_line_t& b);
[[nodiscard]] marking_line_t piece_of(const marking_line_t& line, std::size_t first, std::size_t last);

namespace viewer::store {

using MarkingLines = BoxedLines<marking_lines_t>;

}  // namespace viewer::store
}  // namespace curbstone
