#include "common/config/version.hpp"

namespace curbstone {

std::string version() {
  return CURBSTONE_VERSION_TEXT;
}

}  // namespace curbstone
