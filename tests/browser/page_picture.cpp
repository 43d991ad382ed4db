// page_picture URL PNG SECONDS: opens a page, lets it run, and draws it. scripts/page-picture calls it.
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "tools/browser/browser.hpp"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: page_picture URL PNG SECONDS\n");
    return 2;
  }
  try {
    curbstone::browser::Browser browser([] {});
    browser.open(argv[1]);
    browser.pass(std::atof(argv[3]));
    browser.save_picture(argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "page_picture: %s\n", error.what());
    return 1;
  }
  return 0;
}
