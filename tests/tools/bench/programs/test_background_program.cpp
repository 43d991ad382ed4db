#include "tools/bench/programs/background_program.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

#include "tests/temporary_folder.hpp"

namespace curbstone::bench::programs {
namespace {

TEST(BackgroundProgram, EndsEvenWhereItsOwnerIsKilled) {
  const test::TemporaryFolder folder;
  const std::string output = folder / "output";
  const pid_t owner = fork();
  if (owner == 0) {
    const BackgroundProgram program("sh -c 'echo $$; exec sleep 600'", output);
    for (;;) pause();
  }
  const auto comes_to = [](const std::function<bool()>& condition) {
    for (int i = 0; i < 3000 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return condition();
  };
  pid_t program = 0;
  ASSERT_TRUE(comes_to([&] { return static_cast<bool>(std::ifstream(output) >> program); }));
  kill(owner, SIGKILL);
  waitpid(owner, nullptr, 0);
  const std::string command = "/proc/" + std::to_string(program) + "/cmdline";  // nobody may collect it: empty then
  EXPECT_TRUE(comes_to([&] { return std::ifstream(command).get() == EOF; }));
}

}  // namespace
}  // namespace curbstone::bench::programs
