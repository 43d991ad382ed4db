#include "tests/foxglove/readers.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "tests/paths.hpp"

namespace curbstone::test {
namespace {

namespace fs = std::filesystem;

/// Tests may run at the same time: the folder gets its name when it is whole.
bool install(const fs::path& folder) {
  const fs::path sources = test::source_path("tests/foxglove");
  const std::string lock = folder.string() + ".lock";
  const std::string command =
      "mkdir -p " + folder.string() + " && flock " + lock + " sh -c 'cd " + folder.string() +
      " && for f in package.json package-lock.json; do cmp -s " + sources.string() +
      "/$f $f || rm -f installed; done; "
      "cp " +
      sources.string() + "/*.json " + sources.string() + "/*.mjs . && " +
      "{ [ -e installed ] || { timeout 60 npm ci --ignore-scripts --no-audit --no-fund && touch installed; }; }' "
      ">/dev/null 2>&1";
  return std::system(command.c_str()) == 0;
}

}  // namespace

std::optional<std::string> foxglove_packages() {
  static const std::optional<std::string> folder = []() -> std::optional<std::string> {
    if (std::system("command -v node >/dev/null && command -v npm >/dev/null") != 0) return std::nullopt;
    if (!install(test::build_path("tests/foxglove"))) return std::nullopt;
    return test::build_path("tests/foxglove");
  }();
  return folder;
}

std::string output_of(const std::string& command) {
  std::string output;
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return "";
  std::array<char, 65536> buffer{};
  while (const std::size_t size = std::fread(buffer.data(), 1, buffer.size(), pipe)) output.append(buffer.data(), size);
  EXPECT_EQ(pclose(pipe), 0) << command << "\n" << output;
  return output;
}

}  // namespace curbstone::test
