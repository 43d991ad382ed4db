#pragma once

#include <optional>
#include <string>

#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::filter {

/// What a filter believes, in a file, for the process that comes after it was killed. A small binary file of this
/// machine's byte order with a checksum, replaced in one step; it belongs on a tmpfs (/run). Nobody else reads it.

/// False if it cannot be written.
bool save_state(const std::string& path, const model::Belief& belief);
/// Nothing if there is none, or if it is not whole, of another version, or not finite.
[[nodiscard]] std::optional<model::Belief> load_state(const std::string& path);

}  // namespace curbstone::ekf::filter
