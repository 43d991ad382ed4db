#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace curbstone::viewer::web {

/// A file of the page.
struct Asset {
  std::string type;  ///< for Content-Type
  std::string bytes;
};

/// The file of the page at `path` ("/": the page itself); empty for any other name. Embedded in the program, or, if
/// `folder` is not empty, read from that folder at each call, for development of the page.
[[nodiscard]] std::optional<Asset> find_asset(std::string_view path, const std::string& folder);

}  // namespace curbstone::viewer::web
