#pragma once

#include <stdexcept>
#include <string>

#include "services/semantic_map/picture/canvas.hpp"

namespace curbstone::semantic_map::picture {

/// One line that names the file and the error.
class PictureError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Writes a PNG; the file is complete or not there at all. A device or a pipe (/dev/null, for example) is written to
/// directly, and not replaced. Throws PictureError.
void write_png(const Canvas& canvas, const std::string& path);

}  // namespace curbstone::semantic_map::picture
