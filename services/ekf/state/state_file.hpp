#pragma once

#include <optional>
#include <string>

#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::state {

/// A filter's belief in a file, for the process that follows after it was killed. The file is small and binary, in this
/// machine's byte order, with a checksum, and is replaced atomically; it belongs on a tmpfs (/run). No other program
/// reads it.

/// Saves the belief. Returns false if the file cannot be written.
bool save_state(const std::string& path, const model::Belief& belief);
/// Loads the belief. Nothing if there is no file, or if it is incomplete, of another version, or not finite.
[[nodiscard]] std::optional<model::Belief> load_state(const std::string& path);

}  // namespace curbstone::ekf::state
