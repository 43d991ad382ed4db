#include "tools/replay/replay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <curbstone/service_config_t.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "common/log/log_reader.hpp"
#include "common/log/log_writer.hpp"
#include "common/log/message_order.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/command/run_subcommand.hpp"
#include "tools/simulate/simulate.hpp"

namespace curbstone::replay {
namespace {

int run(command::Run subcommand, std::vector<std::string> words) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  const std::string name = words[0];
  return command::run_subcommand(name, subcommand, static_cast<int>(argv.size()), argv.data());
}

std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class ReplayOnThreads : public ::testing::Test {
 protected:
  void make_town(const std::string& seconds, const std::string& speed = "3") {
    ASSERT_EQ(run(simulate::run_simulate,
                  {"simulate", "--town", "--seconds", seconds, "--set", "speed=" + speed, "--log", log_}),
              0);
  }
  /// The map, and every message that was said.
  std::pair<std::string, std::string> replay(const std::string& threads,
                                             const std::string& setting = "ekf.fuse_map=false",
                                             const std::vector<std::string>& more = {}) {
    const std::string map = folder_ / ("map" + threads + ".db");
    const std::string all = folder_ / ("all" + threads + ".lcmlog");
    std::vector<std::string> words = {"replay", log_,       "--map", map,     "--threads",
                                      threads,  "--record", all,     "--set", setting};
    for (const std::string& s : more) words.insert(words.end(), {"--set", s});
    EXPECT_EQ(run(run_replay, words), 0);
    return {bytes_of(map), bytes_of(all)};
  }
  /// Without all sensors between these times, s of the log.
  void silence(double from, double until) {
    const std::vector<LogEvent> events = read_events();
    LogWriter writer(log_);
    for (const LogEvent& event : events) {
      const double at = static_cast<double>(event.log_utime - events.front().log_utime) * 1e-6;
      if (at < from || at > until)
        writer.write(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()), event.log_utime);
    }
  }
  /// The log says that the mapper had this configuration.
  void record_mapper(const std::string& yaml) {
    const std::vector<LogEvent> events = read_events();
    service_config_t config{};
    config.section = "mapper";
    config.yaml = yaml;
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(config.getEncodedSize()));
    config.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    LogWriter writer(log_);
    writer.write("CONFIG", bytes.data(), static_cast<int>(bytes.size()), events.front().log_utime);
    for (const LogEvent& event : events) {
      if (event.channel != "CONFIG")
        writer.write(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()), event.log_utime);
    }
  }
  [[nodiscard]] std::vector<LogEvent> read_events() const { return events_of(log_); }
  static std::vector<LogEvent> events_of(const std::string& log) {
    std::vector<LogEvent> events;
    LogReader reader(log);
    while (auto event = reader.next()) events.push_back(std::move(*event));
    return events;
  }
  /// Without all sensors for a while, without the IMU for another, and with packets whose clock is off.
  void damage() {
    std::vector<LogEvent> events = read_events();
    const std::int64_t begin = events.front().log_utime;
    LogWriter writer(log_);
    for (std::size_t i = 0; i < events.size(); ++i) {
      const double at = static_cast<double>(events[i].log_utime - begin) * 1e-6;
      if (at > 2 && at < 2.7) continue;
      if (events[i].channel == "IMU" && at > 3.5 && at < 4) continue;
      if (i % 997 == 0) events[i].bytes.resize(events[i].bytes.size() / 2);
      writer.write(events[i].channel, events[i].bytes.data(), static_cast<int>(events[i].bytes.size()),
                   events[i].log_utime);
    }
  }

  test::TemporaryFolder folder_;
  std::string log_ = folder_ / "drive.lcmlog";
};

TEST_F(ReplayOnThreads, MakesTheSameMapAndSaysTheSameAsInOne) {
  make_town("6");
  testing::internal::CaptureStdout();
  const auto one = replay("1");
  const std::string said = testing::internal::GetCapturedStdout();
  EXPECT_EQ(said.find("dropped."), std::string::npos) << "of an undisturbed drive: " << said;
  EXPECT_GT(one.first.size(), 20'000U);
  const auto many = replay("4");
  EXPECT_TRUE(one.first == many.first);
  EXPECT_TRUE(one.second == many.second);
  const std::vector<LogEvent> record = events_of(folder_ / "all1.lcmlog");
  EXPECT_TRUE(std::ranges::is_sorted(record, {}, &LogEvent::log_utime)) << "whoever plays it would wait";
  EXPECT_TRUE(std::ranges::any_of(record, [](const LogEvent& event) { return message_time(event) < event.log_utime; }));
}

TEST_F(ReplayOnThreads, MakesTheSameMapOfADamagedDrive) {
  make_town("6");
  damage();
  const auto one = replay("1", "ekf.fuse_map=true");
  const auto many = replay("4", "ekf.fuse_map=true");
  EXPECT_GT(one.first.size(), 20'000U);
  EXPECT_TRUE(one.first == many.first);
  EXPECT_TRUE(one.second == many.second);
}

/// What the mapper sends later than the vehicle has it, or a worker lets go too early, is missing in one of them.
TEST_F(ReplayOnThreads, MakesTheSameMapHoweverSoonTilesBehindTheVehicleAreLetGo) {
  make_town("25", "12");
  const auto kept = replay("4", "tensor_voting.keep_radius=1000000");
  const auto let_go = replay("4", "tensor_voting.keep_radius=40");
  EXPECT_GT(kept.first.size(), 100'000U);
  EXPECT_TRUE(kept.first == let_go.first);
}

TEST_F(ReplayOnThreads, MakesTheSameMapWhereverFarTilesLie) {
  make_town("20", "12");
  const std::vector<std::string> few = {"mapper.dense.awake=5", "mapper.dense.asleep_here=0", "mapper.keep_free=0"};
  const auto in_memory = replay("4", "mapper.far_folder=", few);
  const auto in_a_file = replay("4", "mapper.far_folder=" + folder_.path().string(), few);
  EXPECT_GT(in_memory.first.size(), 100'000U);
  EXPECT_TRUE(in_memory.first == in_a_file.first) << "curbs, classes and all";
}

/// As after a loop was closed: the mapper sends all of its map in a new epoch, most of it far from the vehicle, and the
/// drive ends meanwhile.
TEST_F(ReplayOnThreads, TheMapIsWholeHoweverSoonTheDriveEndsAfterItIsSentAgain) {
  make_town("20", "12");
  const std::string site = "mapper.folder=" + (folder_ / "site").string();
  (void)replay("1", site);
  silence(6, 1000);
  for (const char* const threads : {"2", "4"}) {
    testing::internal::CaptureStdout();
    (void)replay(threads, site, {"mapper.mode=extend", "tensor_voting.keep_radius=40"});
    EXPECT_THAT(testing::internal::GetCapturedStdout(), ::testing::Not(::testing::HasSubstr("dropped.")));
    const semantic_map::store::MapReader before(folder_ / "map1.db");
    const semantic_map::store::MapReader after(folder_ / ("map" + std::string(threads) + ".db"));
    EXPECT_THAT(after.tile_keys(), ::testing::IsSupersetOf(before.tile_keys()));
  }
}

TEST_F(ReplayOnThreads, KeepsEachPartOfADriveThatTheMapperCouldNotJoin) {
  ASSERT_EQ(run(simulate::run_simulate,
                {"simulate", "--straight", "500", "--seconds", "38", "--set", "speed=10", "--log", log_}),
            0);
  silence(10, 19);
  testing::internal::CaptureStdout();
  const std::string last = replay("2").first;
  const std::string said = testing::internal::GetCapturedStdout();
  const std::string earlier = folder_ / "map2-20250615T150641Z-2.db";
  EXPECT_THAT(said, ::testing::HasSubstr("what was mapped before is kept in " + earlier));
  EXPECT_THAT(said, ::testing::HasSubstr("an earlier drive of this log -> " + earlier));
  const semantic_map::store::MapReader first(earlier);
  const semantic_map::store::MapReader second(folder_ / "map2.db");
  EXPECT_LT(first.trajectory().back().utime, second.trajectory().front().utime);

  silence(10, 1000);
  (void)replay("1");
  const semantic_map::store::MapReader alone(folder_ / "map1.db");
  EXPECT_EQ(first.tile_keys(), alone.tile_keys());
  EXPECT_EQ(first.curbs().size(), alone.curbs().size()) << "the part is as whole as if the drive had ended with it";
  EXPECT_FALSE(std::filesystem::exists(folder_ / "map2.db.part"));
}

TEST_F(ReplayOnThreads, RefusesToSetWhatNobodyReadsAndLeavesTheMapThatIsThere) {
  make_town("1");
  const std::string map = folder_ / "map.db";
  const auto set = [&](const std::string& assignment) {
    return run(run_replay, {"replay", log_, "--map", map, "--set", assignment});
  };
  EXPECT_EQ(set("vehicle.track_width=0.9"), 0);
  const std::string before = bytes_of(map);
  EXPECT_FALSE(before.empty());
  for (const char* const wrong : {"vehicle.tyres=4", "maper.method=loam", "ekf.nonsense=1"}) EXPECT_EQ(set(wrong), 2);
  EXPECT_TRUE(bytes_of(map) == before);
}

TEST_F(ReplayOnThreads, LeavesTheDenseMapOfTheVehicleAlone) {
  make_town("4");
  const std::string site = folder_ / "site";
  record_mapper("mapper:\n  folder: " + site + "\n");
  (void)replay("1");
  EXPECT_FALSE(std::filesystem::exists(site)) << "it is the drive's, not the replay's";
  (void)replay("1", "mapper.folder=" + site);
  EXPECT_TRUE(std::filesystem::exists(site)) << "the user names it";
  std::filesystem::remove_all(site);
  std::ofstream(folder_ / "ugv.yaml") << "mapper:\n  folder: " << site << "\n";
  EXPECT_EQ(run(run_replay, {"replay", log_, "--map", folder_ / "map.db", "--config", folder_ / "ugv.yaml"}), 0);
  EXPECT_FALSE(std::filesystem::exists(site)) << "the file is the vehicle's";

  record_mapper("mapper:\n  folder: " + site + "\n  mode: extend\n");
  testing::internal::CaptureStderr();
  EXPECT_EQ(run(run_replay, {"replay", log_, "--map", folder_ / "map.db"}), 2);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), ::testing::HasSubstr("--set mapper.folder=COPY"));
}

TEST_F(ReplayOnThreads, EndsWithoutAMapThatCannotBeWritten) {
  make_town("0.5");
  for (const std::string threads : {"1", "4"})
    EXPECT_NE(run(run_replay, {"replay", log_, "--map", "/dev/null/map.db", "--threads", threads}), 0);
}

TEST_F(ReplayOnThreads, FailsWhereTheDiskIsFullAndLeavesTheMapThatIsThere) {
  make_town("4");
  const std::string map = folder_ / "map.db";
  ASSERT_EQ(run(run_replay, {"replay", log_, "--map", map}), 0);
  const std::string whole = bytes_of(map);
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit full{50'000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &full);
  testing::internal::CaptureStderr();
  const int status = run(run_replay, {"replay", log_, "--map", map});
  const std::string said = testing::internal::GetCapturedStderr();
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(status, 1);
  EXPECT_NE(said.find("map.db: the map is not written whole"), std::string::npos) << said;
  EXPECT_TRUE(bytes_of(map) == whole);
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(map).parent_path()))
    names.push_back(entry.path().filename());
  EXPECT_THAT(names, testing::UnorderedElementsAre("drive.lcmlog", "map.db")) << "no part of the other";
}

TEST_F(ReplayOnThreads, EndsWhenTheRecordCannotBeWritten) {
  make_town("2");
  for (const std::string threads : {"1", "4"}) {
    std::ofstream(folder_ / "kept.lcmlog") << "an earlier record";
    EXPECT_NE(run(run_replay, {"replay", log_, "--map", "/dev/null/map.db", "--record", folder_ / "kept.lcmlog"}), 0);
    EXPECT_EQ(bytes_of(folder_ / "kept.lcmlog"), "an earlier record");
    EXPECT_EQ(
        run(run_replay, {"replay", log_, "--map", folder_ / "map.db", "--threads", threads, "--record", "/dev/full"}),
        1);
  }
}

/// A slip of the fingers cost the recording: it was deleted before it was read, or emptied while it was.
TEST_F(ReplayOnThreads, DestroysNeitherItsLogNorWhatIsNoMap) {
  make_town("1");
  const std::string log = bytes_of(log_);
  std::filesystem::create_symlink(log_, folder_ / "link");
  const std::string notes = folder_ / "notes.txt";
  std::ofstream(notes) << "what was driven today";
  const std::string map = folder_ / "map.db";
  const std::string pipe = folder_ / "pipe";  // as /dev/null is none
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(run(run_replay, {"replay", log_, "--map", log_}), 1);
  EXPECT_EQ(run(run_replay, {"replay", log_, "--map", map, "--record", log_}), 1);
  EXPECT_EQ(run(run_replay, {"replay", log_, "--map", map, "--record", folder_ / "link"}), 1);
  EXPECT_EQ(run(run_replay, {"replay", log_, "--map", notes}), 1);
  EXPECT_EQ(run(run_replay, {"replay", log_, "--map", pipe}), 1);
  EXPECT_TRUE(bytes_of(log_) == log);
  EXPECT_EQ(bytes_of(notes), "what was driven today");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  std::ofstream(map).flush();  // empty: an earlier replay was killed before it wrote
  for (int again = 0; again < 2; ++again) EXPECT_EQ(run(run_replay, {"replay", log_, "--map", map}), 0);
}

}  // namespace
}  // namespace curbstone::replay
