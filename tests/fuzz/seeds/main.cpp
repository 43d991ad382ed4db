// fuzz_seeds OUT DATA: what the fuzzers start from, made by the emulators of the devices, and cut from recordings in
// DATA where there are any. Recordings are never committed, and so neither are seeds.
#include <cstdio>
#include <exception>

#include "tests/fuzz/seeds/seed_folder.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: fuzz_seeds OUT DATA\n");
    return 2;
  }
  try {
    const curbstone::fuzz::SeedFolder folder(argv[1], argv[2]);
    write_lidar_seeds(folder);
    write_line_seeds(folder);
    write_text_seeds(folder);
    write_bus_seeds(folder);
    write_map_seeds(folder);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fuzz_seeds: %s\n", error.what());
    return 1;
  }
  return 0;
}
