#include "drivers/lidar/sources/capture_contents.hpp"

#include <gmock/gmock.h>

#include "tests/drivers/lidar/captures.hpp"

namespace curbstone::lidar::sources {
namespace {

using ::testing::HasSubstr;

TEST(CaptureContents, CountsPacketsByPortSenderAndLength) {
  const Capture capture({frame(Bytes(1206), 2368, 0, 201), frame(Bytes(512), 8308, 0, 201),
                         frame(Bytes(1206), 2368, 0, 201), frame(Bytes(1206), 2368, 0, 202), frame(Bytes(4), 8308)});
  const CaptureContents contents = contents_of(capture.name());
  EXPECT_EQ(contents.packets, 5);
  ASSERT_EQ(contents.ports.size(), 4U);
  EXPECT_EQ(contents.ports[0].packets, 2);
  EXPECT_EQ(to_text(contents, 1), "port 2368 from 192.168.1.201: 2 packets of 1206 bytes; 3 other ports");
}

TEST(CaptureContents, NamesWhatIsNotUdpToo) {
  Bytes fragment = frame({1}, 1);
  fragment[20] = 0x20;
  const Capture capture({fragment, frame({1, 2}, 9), frame({1}, 9)});
  EXPECT_EQ(to_text(contents_of(capture.name())),
            "port 9 from 192.168.1.200: 2 packets of 1 to 2 bytes; 1 IP fragments");
  const Capture nothing(std::vector<Bytes>{{1, 2, 3}});
  EXPECT_EQ(to_text(contents_of(nothing.name())), "no UDP packet at all; 1 frames cut off");
}

TEST(CaptureContents, TellsWhatAFileHasThatIsCutOff) {
  const Capture capture({frame({1, 2, 3}, 6699), frame({4, 5, 6}, 6699)});
  capture.cut(2);
  EXPECT_EQ(contents_of(capture.name()).packets, 1);
}

}  // namespace
}  // namespace curbstone::lidar::sources
