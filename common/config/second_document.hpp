#pragma once

#include <string>

namespace curbstone {

/// Throws ConfigError if anything but empty documents follows the first YAML document of `text`, because it would never
/// be read. `name` is the file, for the error. Throws YAML::ParserException if the text is not YAML.
void refuse_second_document(const std::string& text, const std::string& name);

}  // namespace curbstone
