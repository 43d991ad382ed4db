#include "tools/output/inputs.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <system_error>

namespace curbstone::output {

void refuse_to_overwrite(const std::vector<std::string>& inputs, const std::filesystem::path& out) {
  for (const std::string& input : inputs) {
    std::error_code not_there;
    if (std::filesystem::equivalent(input, out, not_there))
      throw std::runtime_error(fmt::format("{}: is read from: give another file to write", out.string()));
  }
}

}  // namespace curbstone::output
