#include "services/viewer/web/assets.hpp"

#include <array>
#include <fstream>
#include <iterator>

#include "services/viewer/page/page_files.hpp"

namespace curbstone::viewer::web {
namespace {

struct Known {
  std::string_view path;
  std::string_view file;
  std::string_view type;
  std::string_view (*bytes)();
};

constexpr std::array kKnown = {
    Known{"/", "index.html", "text/html; charset=utf-8", page::index_html},
    Known{"/page.js", "page.js", "text/javascript; charset=utf-8", page::page_js},
    Known{"/page.css", "page.css", "text/css; charset=utf-8", page::page_css},
    Known{"/icon.svg", "icon.svg", "image/svg+xml", page::icon_svg},
};

}  // namespace

std::optional<Asset> find_asset(std::string_view path, const std::string& folder) {
  for (const Known& known : kKnown) {
    if (known.path != path) continue;
    if (folder.empty()) return Asset{std::string(known.type), std::string(known.bytes())};
    std::ifstream file(folder + "/" + std::string(known.file), std::ios::binary);
    if (!file) return std::nullopt;
    return Asset{std::string(known.type), {std::istreambuf_iterator<char>(file), {}}};
  }
  return std::nullopt;
}

}  // namespace curbstone::viewer::web
