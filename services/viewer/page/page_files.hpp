#pragma once

#include <string_view>

namespace curbstone::viewer::page {

/// The files of the page, embedded in the program by the build.
[[nodiscard]] std::string_view index_html();
[[nodiscard]] std::string_view page_js();
[[nodiscard]] std::string_view page_css();
[[nodiscard]] std::string_view icon_svg();

}  // namespace curbstone::viewer::page
