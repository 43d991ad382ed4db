// Each single damage of an SLCAN adapter's serial line, which has no checksum: at each byte of a line with positions.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "drivers/encoder/can/slcan.hpp"
#include "tests/drivers/encoder/encoder_on_a_bus.hpp"

namespace curbstone::encoder {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct DamagedLine {
  const char* name;
  void (*apply)(Bytes& line, std::size_t at);
};

constexpr std::array kDamagedLines = {
    DamagedLine{"lost", [](Bytes& l, std::size_t at) { l.erase(l.begin() + static_cast<std::ptrdiff_t>(at)); }},
    DamagedLine{"two lost",
                [](Bytes& l, std::size_t at) {
                  const auto begin = l.begin() + static_cast<std::ptrdiff_t>(at);
                  l.erase(begin, begin + std::min<std::ptrdiff_t>(2, l.end() - begin));
                }},
    DamagedLine{"four lost",
                [](Bytes& l, std::size_t at) {
                  const auto begin = l.begin() + static_cast<std::ptrdiff_t>(at);
                  l.erase(begin, begin + std::min<std::ptrdiff_t>(4, l.end() - begin));
                }},
    DamagedLine{"the rest lost", [](Bytes& l, std::size_t at) { l.resize(at); }},
    DamagedLine{"doubled",
                [](Bytes& l, std::size_t at) { l.insert(l.begin() + static_cast<std::ptrdiff_t>(at), l[at]); }},
    DamagedLine{"lowest bit", [](Bytes& l, std::size_t at) { l[at] ^= 0x01; }},
    DamagedLine{"bit 3", [](Bytes& l, std::size_t at) { l[at] ^= 0x08; }},
    DamagedLine{"highest bit", [](Bytes& l, std::size_t at) { l[at] ^= 0x80; }},
};

class DamagedLines : public EncoderThatListens, public ::testing::WithParamInterface<bool> {
 public:
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
  }
  /// rad, the published angle that is farthest from the truth.
  double worst_angle() {
    const auto& messages = rig_.messages();
    double worst = 0;
    for (const wheels_t& m : messages) {
      for (const double angle : {m.angle[0], m.angle[1]})
        worst = std::max(worst, std::abs(angle - rig_.angle(m.utime) + rig_.angle(messages[0].utime)));
    }
    return worst;
  }
};

/// One of the drives of a test.
struct FreshDrive : DamagedLines {
  using DamagedLines::rig_;
  void TestBody() override {}
};

/// A digit that has become another digit cannot be told from a count, only from the counts around it.
TEST_P(DamagedLines, CostTheirSampleAndMoveNoAngle) {
  const std::size_t size = GetParam() ? 26 : 22;
  int runs = 0, lost = 0;
  double worst = 0;
  for (const int index : {100, 101}) {
    for (std::size_t at = 0; at < size; ++at) {
      for (const DamagedLine& damage : kDamagedLines) {
        FreshDrive fresh;
        fresh.play(index, [&](Bytes& line) { damage.apply(line, at); });
        ++runs;
        const auto& messages = fresh.rig_.messages();
        lost += 200 - static_cast<int>(messages.size());
        const double most = fresh.worst_angle();
        const auto where = ::testing::Message() << damage.name << " at " << at << " of line " << index;
        ASSERT_GE(messages.size(), 198U) << where;
        if (messages.size() < 200) {
          EXPECT_GT(fresh.rig_.count("lost.samples") + fresh.rig_.count("refused.jump") +
                        fresh.rig_.count("refused.old_counts") + fresh.rig_.count("refused.length") +
                        fresh.rig_.count("refused.outlier") + fresh.rig_.count("withheld.unsure"),
                    0)
              << where;
        }
        for (std::size_t i = 1; i < messages.size(); ++i)
          ASSERT_EQ((messages[i].utime - messages[0].utime) % 10'000, 0) << where;
        worst = std::max(worst, most);
        if (most < 0.014) continue;
        ADD_FAILURE() << where << ": " << most << " rad";
      }
    }
  }
  std::printf("[ figure ] %d damages cost %d samples; the worst angle is off by %.4f rad\n", runs, lost, worst);
}
/// The least that a wheel cannot do at 100 Hz is 8 counts.
TEST_P(DamagedLines, WithADigitOfACountAreRefusedAtEachSpeed) {
  std::mt19937 random(3);
  for (const double speed : {0.0, 0.3, -3.0, 30.0, 100.0}) {
    for (const int index : {0, 1, 2, 3, 40, 199}) {
      for (int digit = 0; digit < 16; ++digit) {
        FreshDrive fresh;
        fresh.rig_.speed = speed;
        const char changed = "0123456789ABCDEF"[random() % 16];
        fresh.play(index, [&](Bytes& line) {
          line[5 + static_cast<std::size_t>(digit)] = static_cast<std::uint8_t>(changed);
        });
        const auto where = ::testing::Message() << speed << " rad/s, line " << index << ", digit " << digit;
        EXPECT_LT(fresh.worst_angle(), index < 4 ? 0.03 : 0.014) << where;
        EXPECT_GE(fresh.rig_.messages().size(), index < 4 ? 193U : 198U) << where;
      }
    }
  }
}
INSTANTIATE_TEST_SUITE_P(TimeStamps, DamagedLines, ::testing::Bool());

}  // namespace
}  // namespace curbstone::encoder
