#include "tools/replay/stage_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <curbstone/tile_index_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace curbstone::replay {
namespace {

/// Passes on what it hears, numbered; at each tick it asks the node before it for something, and says what it was
/// asked.
class Relay final : public Node {
 public:
  Relay(int number, LocalBus& bus) : number_(number), bus_(bus) {}

  void connect(Subscriber& bus) override {
    bus.subscribe<tile_index_t>("STEP" + std::to_string(number_), [this](const tile_index_t& m) { pass_on(m); });
    bus.subscribe<tile_request_t>("ASK" + std::to_string(number_), [this](const tile_request_t& m) {
      tile_index_t answer{};
      answer.utime = m.utime;
      answer.owner = "answer " + std::to_string(number_);
      bus_.publish("STEP" + std::to_string(number_ + 1), answer);
    });
  }
  void end_drive() override { ended_after = heard_; }
  void tick(std::int64_t now) override {
    ticked = now;
    if (throws_at == now) throw std::runtime_error("broken");
    tile_request_t ask{};
    ask.utime = now + heard_;
    for (int to = 0; to < number_; ++to) bus_.publish("ASK" + std::to_string(to), ask);
  }
  void finish() override {
    tile_index_t last{};
    last.utime = heard_;
    last.owner = "last of " + std::to_string(number_);
    pass_on(last);
  }
  [[nodiscard]] NodeReport report() const override { return {}; }

  std::int64_t throws_at = -1;
  std::int64_t ticked = 0;
  std::int64_t ended_after = -1;  // messages

 private:
  void pass_on(tile_index_t m) {
    m.page = static_cast<std::int32_t>(++heard_);
    bus_.publish("STEP" + std::to_string(number_ + 1), m);
  }
  int number_;
  LocalBus& bus_;
  std::int64_t heard_ = 0;
};

struct Line {
  explicit Line(bool threads) {
    std::vector<std::unique_ptr<StageGroup>> groups;
    for (int number = 0; number < 3; ++number) {
      groups.push_back(std::make_unique<StageGroup>(1 + number));
      nodes.push_back(std::make_unique<Relay>(number, groups.back()->bus()));
      groups.back()->add(*nodes.back());
    }
    line.emplace(std::move(groups), StageLine::Options{threads, [this](const LineItem& item) {
                                                         said.push_back({item.channel, item.bytes});
                                                       }});
  }
  void drive(int beats) {
    for (int beat = 0; beat < beats; ++beat) {
      for (int i = 0; i < 100; ++i) {
        tile_index_t message{};
        message.utime = beat * 100 + i;
        std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
        message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
        line->deliver("STEP0", bytes);
      }
      line->beat(1'000'000 + beat, beat % 5 != 3);
    }
    line->finish();
  }

  std::vector<std::unique_ptr<Relay>> nodes;
  std::vector<std::pair<std::string, std::vector<std::uint8_t>>> said;
  std::optional<StageLine> line;
};

TEST(StageLine, SaysTheSameInTheSameOrderWithAThreadForEachGroupOrOneForAll) {
  Line one(false);
  one.drive(60);
  EXPECT_GT(one.said.size(), 4U * 6000U);
  for (int run = 0; run < 5; ++run) {
    Line many(true);
    many.drive(60);
    EXPECT_TRUE(many.said == one.said);
  }
}

TEST(StageLine, BringsAnswersToWhatWasAskedWithinTheLag) {
  Line line(true);
  line.drive(60);
  const auto asked = [&](const std::string& channel) {
    return std::count_if(line.said.begin(), line.said.end(), [&](const auto& m) { return m.first == channel; });
  };
  // 60 beats, of which 12 do not tick.
  EXPECT_GE(asked("ASK0"), 40);
  // What the two later groups ask last, when the drive is over, is after the first has finished.
  EXPECT_EQ(asked("STEP1"), 6000 + 1 + asked("ASK0") - 2);
}

TEST(StageLine, EndsADriveInEachGroupBehindItsMessagesAndTicksOn) {
  for (const bool threads : {false, true}) {
    Line line(threads);
    tile_index_t message{};
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    for (int i = 0; i < 100; ++i) line.line->deliver("STEP0", bytes);
    line.line->end_drive();
    for (int beat = 0; beat <= 30; ++beat) line.line->beat(1'000'000 + beat, true);
    line.line->wait();
    for (const auto& node : line.nodes) {
      EXPECT_EQ(node->ended_after, 100);
      EXPECT_EQ(node->ticked, 1'000'030) << "all have reached the last beat";
    }
  }
}

TEST(StageLine, ThrowsWhatANodeHasThrown) {
  for (const bool threads : {false, true}) {
    Line line(threads);
    line.nodes[1]->throws_at = 1'000'010;
    EXPECT_THROW(line.drive(60), std::runtime_error);
  }
}

TEST(StageLine, EndsWithoutBeingFinished) {
  Line line(true);
  line.line->deliver("STEP0", std::vector<std::uint8_t>(3));
  line.line->beat(1, true);
}

}  // namespace
}  // namespace curbstone::replay
