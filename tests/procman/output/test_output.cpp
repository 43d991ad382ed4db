#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "procman/output/line_splitter.hpp"
#include "procman/output/output_keeper.hpp"
#include "procman/output/output_queue.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::procman::output {
namespace {

using ::testing::ElementsAre;

std::string read_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Takes everything off the queue; each message must be fit for the wire.
std::map<std::string, std::string> take_all(OutputQueue& queue, int* messages = nullptr) {
  std::map<std::string, std::string> all;
  while (const auto message = queue.take(1)) {
    EXPECT_LT(message->getEncodedSize(), 48'000);
    EXPECT_EQ(message->command_ids.size(), static_cast<std::size_t>(message->num_commands));
    for (std::size_t i = 0; i < message->command_ids.size(); ++i) all[message->command_ids[i]] += message->text[i];
    if (messages != nullptr) ++*messages;
  }
  return all;
}

TEST(LineSplitter, CutsAtNewlinesAndDropsCarriageReturns) {
  LineSplitter splitter;
  std::vector<std::string> lines;
  const auto keep = [&](std::string_view line) { lines.emplace_back(line); };
  splitter.feed("a\r\nb", keep);
  splitter.feed("c\n\nd", keep);
  EXPECT_THAT(lines, ElementsAre("a", "bc", ""));
  splitter.flush(keep);
  splitter.flush(keep);
  EXPECT_THAT(lines, ElementsAre("a", "bc", "", "d"));
  splitter.feed(std::string(10000, 'x'), keep);
  EXPECT_EQ(lines.back().size(), LineSplitter::kMaxLine);
}

TEST(OutputQueue, GroupsInterleavedCommandsInOneMessage) {
  OutputQueue queue("d");
  queue.add("a", "1\r\n");
  queue.add("b", "2\r\n");
  queue.add("a", "3\r\n");
  queue.add("", "words of the deputy\n");
  const auto message = queue.take(7);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->utime, 7);
  EXPECT_EQ(message->deputy_id, "d");
  EXPECT_THAT(message->command_ids, ElementsAre("a", "b", ""));
  EXPECT_THAT(message->text, ElementsAre("1\r\n3\r\n", "2\r\n", "words of the deputy\n"));
  EXPECT_FALSE(queue.take(8));
}

TEST(OutputQueue, ABurstOfOneMegabyteArrivesCompleteInBoundedMessages) {
  OutputQueue queue("d");
  std::string sent;
  for (int i = 0; sent.size() < 1'000'000; ++i) sent += fmt::format("line {} \u00e4\u20ac\r\n", i);
  for (std::size_t at = 0; at < sent.size(); at += 1023) queue.add("a", sent.substr(at, 1023));
  int messages = 0;
  EXPECT_EQ(take_all(queue, &messages)["a"], sent);
  EXPECT_LT(messages, 40);
  EXPECT_EQ(queue.dropped(), 0);
}

TEST(OutputQueue, AFloodIsBoundedCountedAndSaid) {
  OutputQueue queue("d");
  const std::string block(100'000, 'x');
  for (int i = 0; i < 100; ++i) queue.add("a", block);
  EXPECT_EQ(queue.dropped(), 10'000'000 - 4'100'000 - 0 + 0) << "41 blocks fit";
  auto all = take_all(queue);
  EXPECT_EQ(all["a"].size(), 4'100'000U);
  EXPECT_THAT(all[""], ::testing::HasSubstr("5900000 bytes of output dropped"));
  queue.add("a", "again");
  EXPECT_EQ(take_all(queue)["a"], "again");
}

TEST(OutputQueue, BadUtf8AndZeroBytesBecomeReplacementCharacters) {
  OutputQueue queue("d");
  queue.add("a", std::string_view("x\0y\xff\xc3(\xed\xa0\x80\xf5", 10));
  const std::string r = "\uFFFD";
  EXPECT_EQ(take_all(queue)["a"], "x" + r + "y" + r + r + "(" + r + r + r + r);
}

TEST(OutputQueue, CharactersCutByAReadAreJoined) {
  OutputQueue queue("d");
  const std::string euro = "\u20ac";
  for (const char c : "1" + euro + "2") queue.add("a", std::string(1, c));
  EXPECT_EQ(take_all(queue)["a"], "1" + euro + "2");
}

TEST(OutputQueue, RandomBytesAlwaysDecode) {
  std::mt19937 random(3);
  OutputQueue queue("d");
  for (int i = 0; i < 2000; ++i) {
    std::string bytes(random() % 300, ' ');
    for (char& c : bytes) c = static_cast<char>(random());
    queue.add(random() % 2 ? "a" : "b", bytes);
  }
  for (const auto& [id, text] : take_all(queue)) {
    EXPECT_EQ(text.find('\0'), std::string::npos);
    Utf8Stream again;
    EXPECT_EQ(again.feed(text), text) << "valid UTF-8 stays as it is";
  }
}

class OutputFolder : public ::testing::Test {
 protected:
  test::TemporaryFolder temporary_;
  std::filesystem::path folder_ = temporary_ / "output";
};

TEST_F(OutputFolder, KeepsTheLastLinesInMemoryAndAllInAFile) {
  OutputKeeper keeper(folder_, {.lines = 2}, [] { return 1'763'885'702'250'000; });
  std::vector<std::string> seen;
  keeper.note("a:1", "-- started");
  keeper.add("a:1", "one\r\ntwo\r\nthree\r\nfo", [&](std::string_view line) { seen.emplace_back(line); });
  EXPECT_THAT(seen, ElementsAre("one", "two", "three"));
  EXPECT_THAT(keeper.last_lines("a:1"), ElementsAre("two", "three"));
  keeper.end("a:1", [](std::string_view) {});
  EXPECT_THAT(keeper.last_lines("a:1"), ElementsAre("three", "fo"));
  const std::string at = "2025-11-23T08:15:02.250Z ";
  EXPECT_EQ(read_file(folder_ / "a:1.log"),
            at + "-- started\n" + at + "one\n" + at + "two\n" + at + "three\n" + at + "fo\n");
}

TEST_F(OutputFolder, RotatesSoThatNoMoreThanTheLimitIsKept) {
  OutputKeeper keeper(folder_, {.lines = 2, .file_bytes = 1000, .old_files = 2});
  for (int i = 0; i < 1000; ++i) keeper.add("a", fmt::format("line {}\n", i), [](std::string_view) {});
  std::uintmax_t total = 0;
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    total += entry.file_size();
    ++files;
  }
  EXPECT_EQ(files, 3);
  EXPECT_LE(total, 3000U);
  EXPECT_THAT(read_file(folder_ / "a.log"), ::testing::EndsWith("line 999\n"));
}

TEST_F(OutputFolder, AnIdCannotLeaveTheFolder) {
  OutputKeeper keeper(folder_);
  keeper.note("../x y", "text");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "..%2fx%20y.log"));
}

TEST_F(OutputFolder, AFullDiskCostsTheFilesOnly) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  OutputKeeper keeper(folder_);
  std::filesystem::create_symlink("/dev/full", folder_ / "a.log");
  keeper.add("a", "one\ntwo\n", [](std::string_view) {});
  EXPECT_EQ(keeper.write_failures(), 2);
  EXPECT_THAT(keeper.last_lines("a"), ElementsAre("one", "two"));
}

TEST_F(OutputFolder, AFullDiskIsAFaultUntilThereIsRoom) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  OutputKeeper keeper(folder_);
  std::filesystem::create_symlink("/dev/full", folder_ / "a.log");
  keeper.note("b", "well");
  EXPECT_FALSE(keeper.fault());
  keeper.note("a", "one");
  ASSERT_TRUE(keeper.fault());
  EXPECT_EQ(*keeper.fault(),
            (folder_ / "a.log").string() + ": No space left on device: what the command prints is kept in memory only");
  std::filesystem::remove(folder_ / "a.log");
  keeper.forget("a");  // a file is opened for a command once
  keeper.note("a", "two");
  EXPECT_FALSE(keeper.fault());
}

/// `rm -r /var/log/curbstone`, or logrotate: lines must not go into a file that nobody finds.
TEST_F(OutputFolder, AFileThatWasDeletedOrRenamedIsBegunAgain) {
  OutputKeeper keeper(folder_, {}, [] { return std::int64_t{0}; });
  keeper.add("a", "one\n", [](std::string_view) {});
  std::filesystem::remove_all(folder_);
  keeper.add("a", "two\n", [](std::string_view) {});
  EXPECT_EQ(read_file(folder_ / "a.log"), "1970-01-01T00:00:00.000Z two\n");
  std::filesystem::rename(folder_ / "a.log", folder_ / "a.log.old");
  keeper.add("a", "three\n", [](std::string_view) {});
  EXPECT_EQ(read_file(folder_ / "a.log"), "1970-01-01T00:00:00.000Z three\n");
  EXPECT_EQ(keeper.write_failures(), 0);
}

TEST_F(OutputFolder, AFileThatCannotBeOpenedIsAFaultThatSaysWhy) {
  OutputKeeper keeper(folder_);
  std::filesystem::create_directory(folder_ / "a.log");
  keeper.note("a", "one");
  ASSERT_TRUE(keeper.fault());
  EXPECT_THAT(*keeper.fault(), ::testing::HasSubstr("Is a directory"));
}

TEST(OutputKeeper, HasTheLastLinesOrAsManyAsAreAskedFor) {
  OutputKeeper keeper("");
  keeper.add("a", "one\ntwo\nthree\n", [](std::string_view) {});
  EXPECT_THAT(keeper.last_lines("a", 2), ElementsAre("two", "three"));
  EXPECT_THAT(keeper.last_lines("a", 9), ElementsAre("one", "two", "three"));
  EXPECT_THAT(keeper.last_lines("b", 9), ElementsAre());
}

TEST(OutputKeeper, AFolderThatCannotBeMadeIsOneClearError) {
  EXPECT_THROW(OutputKeeper("/proc/nowhere/logs"), std::runtime_error);
}

}  // namespace
}  // namespace curbstone::procman::output
