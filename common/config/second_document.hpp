#pragma once

#include <string>

namespace curbstone {

/// Throws ConfigError for whatever stands behind the first YAML document of `text`: nobody would read it. Empty
/// documents are none. `name` is the file, for the error; YAML::ParserException where the text is no YAML.
void refuse_second_document(const std::string& text, const std::string& name);

}  // namespace curbstone
