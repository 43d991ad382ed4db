// page_picture URL PNG SECONDS [WIDTH HEIGHT]: opens a page, lets it run, and saves its picture; with a size, as on a
// phone.
// scripts/page-picture calls it.
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "tools/browser/browser.hpp"

int main(int argc, char** argv) {
  if (argc != 4 && argc != 6) {
    std::fprintf(stderr, "usage: page_picture URL PNG SECONDS [WIDTH HEIGHT]\n");
    return 2;
  }
  try {
    curbstone::browser::Browser browser([] {});
    if (argc == 6) browser.resize(std::atoi(argv[4]), std::atoi(argv[5]), true);
    browser.open(argv[1]);
    browser.pass(std::atof(argv[3]));
    browser.save_picture(argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "page_picture: %s\n", error.what());
    return 1;
  }
  return 0;
}
