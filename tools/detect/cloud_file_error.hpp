#pragma once

#include <stdexcept>

namespace curbstone::detect {

/// A one-line error that names the file.
class CloudFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace curbstone::detect
