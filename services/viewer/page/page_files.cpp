#include "services/viewer/page/page_files.hpp"

// .incbin embeds a file of any size at once; compiling it as a list of numbers takes seconds.
#define CURBSTONE_PAGE_FILE(name, path)                          \
  asm(".pushsection .rodata\n"                                   \
      ".global curbstone_page_" #name                            \
      "\n"                                                       \
      "curbstone_page_" #name                                    \
      ":\n"                                                      \
      ".incbin \"" path                                          \
      "\"\n"                                                     \
      ".global curbstone_page_" #name                            \
      "_end\n"                                                   \
      "curbstone_page_" #name                                    \
      "_end:\n"                                                  \
      ".byte 0\n"                                                \
      ".popsection\n");                                          \
  extern "C" const char curbstone_page_##name[];                 \
  extern "C" const char curbstone_page_##name##_end[];           \
  namespace curbstone::viewer::page {                            \
  std::string_view name() {                                      \
    return {curbstone_page_##name, curbstone_page_##name##_end}; \
  }                                                              \
  }

CURBSTONE_PAGE_FILE(index_html, CURBSTONE_PAGE_BUNDLE "/index.html")
CURBSTONE_PAGE_FILE(page_js, CURBSTONE_PAGE_BUNDLE "/page.js")
CURBSTONE_PAGE_FILE(page_css, CURBSTONE_PAGE_BUNDLE "/page.css")
CURBSTONE_PAGE_FILE(icon_svg, CURBSTONE_PAGE_BUNDLE "/icon.svg")
