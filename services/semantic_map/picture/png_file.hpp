#pragma once

#include <stdexcept>
#include <string>

#include "services/semantic_map/picture/canvas.hpp"

namespace curbstone::semantic_map::picture {

/// One clear line that names the file.
class PictureError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Writes a PNG; the file is there as a whole or not at all. A device or a pipe (/dev/null, say) is written to as it
/// is, and stays. Throws PictureError.
void write_png(const Canvas& canvas, const std::string& path);

}  // namespace curbstone::semantic_map::picture
