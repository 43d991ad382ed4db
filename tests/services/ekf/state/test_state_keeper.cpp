#include "services/ekf/state/state_keeper.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <iterator>
#include <thread>

#include "services/ekf/state/state_file.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::ekf::state {
namespace {

model::Belief belief_at(std::int64_t utime) {
  model::Belief belief;
  belief.utime = utime;
  return belief;
}

bool comes_true(const std::function<bool()>& condition) {
  for (int i = 0; i < 6000 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return condition();
}

TEST(StateKeeper, WritesTheLastBeliefBeforeItGoes) {
  const test::TemporaryFolder folder;
  {
    StateKeeper keeper(folder / "ekf.state");
    for (std::int64_t i = 1; i <= 1000; ++i) keeper.keep(belief_at(i));
  }
  const auto belief = load_state(folder / "ekf.state");
  ASSERT_TRUE(belief);
  EXPECT_EQ(belief->utime, 1000);
}

TEST(StateKeeper, NeverWaitsForAFileSystemThatBlocks) {
  const test::TemporaryFolder folder;
  const std::string unfinished = folder / "ekf.state.unfinished";
  ASSERT_EQ(mkfifo(unfinished.c_str(), 0600), 0) << "nobody reads it yet: to open it for writing blocks";
  std::string written;
  {
    StateKeeper keeper(folder / "ekf.state");
    for (std::int64_t i = 1; i <= 1000; ++i) keeper.keep(belief_at(i));  // would hang here
    std::ifstream reader(unfinished, std::ios::binary);
    written.assign(std::istreambuf_iterator<char>(reader), {});
  }
  EXPECT_FALSE(written.empty());
}

TEST(StateKeeper, FailsUntilTheFolderIsThere) {
  const test::TemporaryFolder folder;
  StateKeeper keeper(folder / "run/ekf.state");
  keeper.keep(belief_at(1));
  ASSERT_TRUE(comes_true([&] { return keeper.failing(); }));
  EXPECT_EQ(keeper.failures(), 1);
  std::filesystem::create_directory(folder / "run");
  keeper.keep(belief_at(2));
  EXPECT_TRUE(comes_true([&] { return !keeper.failing(); }));
}

}  // namespace
}  // namespace curbstone::ekf::state
