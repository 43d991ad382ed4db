#pragma once

#include <cstddef>
#include <curbstone/curb_lines_t.hpp>

#include "services/viewer/store/boxed_lines.hpp"

namespace curbstone {

// What BoxedLines requires of a line.
[[nodiscard]] bool is_sound(const curb_line_t& line);
[[nodiscard]] bool is_same(const curb_line_t& a, const curb_line_t& b);
[[nodiscard]] curb_line_t piece_of(const curb_line_t& line, std::size_t first, std::size_t last);

namespace viewer::store {

using CurbLines = BoxedLines<curb_lines_t>;

}  // namespace viewer::store
}  // namespace curbstone
