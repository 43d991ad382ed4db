// Each single damage of an SLCAN adapter's serial line, which has no checksum: at each byte of a line with positions.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "drivers/encoder/can/slcan.hpp"
#include "tests/drivers/encoder/encoder_on_a_bus.hpp"

namespace curbstone::encoder {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct DamagedLine {
  const char* name;
  bool changes_digit;
  void (*apply)(Bytes& line, std::size_t at);
};

constexpr std::array kDamagedLines = {
    DamagedLine{"lost", false, [](Bytes& l, std::size_t at) { l.erase(l.begin() + static_cast<std::ptrdiff_t>(at)); }},
    DamagedLine{"two lost", false,
                [](Bytes& l, std::size_t at) {
                  const auto begin = l.begin() + static_cast<std::ptrdiff_t>(at);
                  l.erase(begin, begin + std::min<std::ptrdiff_t>(2, l.end() - begin));
                }},
    DamagedLine{"four lost", false,
                [](Bytes& l, std::size_t at) {
                  const auto begin = l.begin() + static_cast<std::ptrdiff_t>(at);
                  l.erase(begin, begin + std::min<std::ptrdiff_t>(4, l.end() - begin));
                }},
    DamagedLine{"the rest lost", false, [](Bytes& l, std::size_t at) { l.resize(at); }},
    DamagedLine{"doubled", false,
                [](Bytes& l, std::size_t at) { l.insert(l.begin() + static_cast<std::ptrdiff_t>(at), l[at]); }},
    DamagedLine{"lowest bit", true, [](Bytes& l, std::size_t at) { l[at] ^= 0x01; }},
    DamagedLine{"bit 3", true, [](Bytes& l, std::size_t at) { l[at] ^= 0x08; }},
    DamagedLine{"highest bit", false, [](Bytes& l, std::size_t at) { l[at] ^= 0x80; }},
};

class DamagedLines : public EncoderThatListens, public ::testing::WithParamInterface<bool> {
 protected:
  /// A drive of 2 s, with damage to the line of a sample.
  void play(int damaged, const std::function<void(Bytes&)>& damage) {
    can::SlcanParser parser;
    for (int i = 0; i < 200; ++i) {
      const std::int64_t now = test::DriveRig::kStart + i * 10'000;
      if (i % 2 == 0) rig_.node.tick(now);
      Bytes line = can::encode_slcan(positions(now));
      if (GetParam()) {
        const std::string stamp = fmt::format("{:04X}", i * 10 % 60'000);
        line.insert(line.end() - 1, stamp.begin(), stamp.end());
      }
      if (i == damaged) damage(line);
      parser.parse(line, {.on_frame = [&](const can::CanFrame& frame) { rig_.node.on_frame(now + 200, frame); },
                          .on_answer = [](auto) {},
                          .on_refused = [&](const char* cause) { rig_.node.on_refused(now + 200, cause); }});
    }
    rig_.node.finish();
    refused_ = parser.counters();
  }
  Counters refused_;
};

/// A digit that has become another digit cannot be told from a count: what a wheel cannot do is refused.
TEST_P(DamagedLines, CostTheirSampleAndMoveNoAngle) {
  struct Fresh : DamagedLines {
    using DamagedLines::play;
    using DamagedLines::rig_;
    void TestBody() override {}
  };
  const std::size_t size = GetParam() ? 26 : 22;
  int runs = 0, lost = 0, wrong = 0;
  double worst = 0;
  for (const int index : {100, 101}) {
    for (std::size_t at = 0; at < size; ++at) {
      for (const DamagedLine& damage : kDamagedLines) {
        Fresh fresh;
        fresh.play(index, [&](Bytes& line) { damage.apply(line, at); });
        ++runs;
        const auto& messages = fresh.rig_.messages();
        lost += 200 - static_cast<int>(messages.size());
        double most = 0;
        for (const wheels_t& m : messages) {
          for (const double angle : {m.angle[0], m.angle[1]})
            most = std::max(most, std::abs(angle - fresh.rig_.angle(m.utime) + fresh.rig_.angle(messages[0].utime)));
        }
        const auto where = ::testing::Message() << damage.name << " at " << at << " of line " << index;
        ASSERT_GE(messages.size(), 198U) << where;
        if (messages.size() < 200) {
          EXPECT_GT(fresh.rig_.count("lost.samples") + fresh.rig_.count("refused.jump") +
                        fresh.rig_.count("refused.old_counts") + fresh.rig_.count("refused.length") +
                        fresh.rig_.count("withheld.unsure"),
                    0)
              << where;
        }
        for (std::size_t i = 1; i < messages.size(); ++i)
          ASSERT_EQ((messages[i].utime - messages[0].utime) % 10'000, 0) << where;
        if (most < 0.012) continue;
        ASSERT_TRUE(damage.changes_digit) << where << ": " << most << " rad";
        worst = std::max(worst, most);
        ++wrong;
      }
    }
  }
  EXPECT_LT(worst, 0.5);
  std::printf("[ figure ] %d damages cost %d samples; %d digits became others, by %.3f rad at most\n", runs, lost,
              wrong, worst);
}
INSTANTIATE_TEST_SUITE_P(TimeStamps, DamagedLines, ::testing::Bool());

}  // namespace
}  // namespace curbstone::encoder
