#include "tests/system/run_program.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "tests/paths.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::system_test {

namespace {

const std::string kPath = "PATH=" + test::program_path("") + ":$PATH; ";

std::string emptied(const std::string& file) {
  std::ofstream(file, std::ios::trunc).flush();
  return file;
}

}  // namespace

std::string read_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write_file(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

ProgramResult run_program(const std::string& command, double seconds) {
  const test::TemporaryFolder folder;
  const std::string line = fmt::format("{}exec timeout -k 2 {} {} >'{}' 2>'{}'", kPath, seconds, command,
                                       (folder / "out").string(), (folder / "err").string());
  ProgramResult result;
  result.exit_status = bench::programs::shell_status(std::system(line.c_str()));
  result.out = read_file(folder / "out");
  result.err = read_file(folder / "err");
  return result;
}

BackgroundProgram::BackgroundProgram(const std::string& command, const std::string& output_file)
    : bench::programs::BackgroundProgram("env PATH=" + test::program_path("") + ":\"$PATH\" " + command,
                                         emptied(output_file)) {}

}  // namespace curbstone::system_test
