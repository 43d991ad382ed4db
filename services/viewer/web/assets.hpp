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

/// The file of the page at `path`, "/" for the page itself; nothing for any other name. From the program, or, if
/// `folder` is not empty, read anew from there: for who works on the page.
[[nodiscard]] std::optional<Asset> find_asset(std::string_view path, const std::string& folder);

}  // namespace curbstone::viewer::web
