// A CANopen node id that nobody on the bus has.
#include <gmock/gmock.h>

#include "drivers/encoder/canopen/nodes_heard.hpp"
#include "drivers/encoder/canopen/wheel_drive.hpp"
#include "tests/drivers/encoder/drive_rig.hpp"

namespace curbstone::encoder {
namespace {

using can::CanFrame;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

TEST(WrongNode, TheNodesThatAreHeardAreNamed) {
  for (const bool configure : {true, false}) {
    EncoderConfig config;
    config.node = 2;
    config.configure = configure;
    test::DriveRig rig(config);
    rig.run_for(100'000);
    rig.receive(rig.now, rig.drive.power_on(rig.now));  // node 1
    rig.run_for(5'000'000);
    EXPECT_THAT(rig.node.report().faults,
                Contains(AllOf(HasSubstr(configure ? "(CAN node 2) does not answer" : "no positions from the drive"),
                               HasSubstr("; heard instead: CAN node 1"))));
  }
}

TEST(WrongNode, OnlyWhileNothingIsHeardOfTheRightOne) {
  canopen::WheelDrive drive({}, {[](const CanFrame&) {}, [](auto, auto) {}, [] {}});
  drive.tick(0);
  EXPECT_EQ(drive.heard_instead(), "");
  drive.on_frame(1, CanFrame::make(0x705, {0x85}));
  EXPECT_EQ(drive.heard_instead(), "; heard instead: CAN node 5");
  drive.on_frame(2, CanFrame::make(0x081, {0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(drive.heard_instead(), "") << "an emergency of the drive itself";
  drive.start(3);
  EXPECT_EQ(drive.heard_instead(), "") << "of the bus before";
  drive.on_frame(4, CanFrame::make(0x705, {0x05}));
  EXPECT_EQ(drive.heard_instead(), "; heard instead: CAN node 5");
}

TEST(NodesHeard, AreThoseWithAHeartbeatOrPositions) {
  canopen::NodesHeard nodes;
  nodes.add(CanFrame::make(0x70C, {0x7F}));
  nodes.add(CanFrame::make(0x182, {1, 2, 3, 4, 5, 6, 7, 8}));
  nodes.add(CanFrame::make(0x70D, {0x33}));              // no state
  nodes.add(CanFrame::make(0x70E, {0x05, 0x00}));        // no heartbeat
  nodes.add(CanFrame::make(0x183, {1, 2, 3, 4, 5, 6}));  // not two positions
  nodes.add(CanFrame::make(0x180, {1, 2, 3, 4, 5, 6, 7, 8}));
  CanFrame frame = CanFrame::make(0x704, {0x05});
  frame.extended = true;
  nodes.add(frame);
  EXPECT_EQ(nodes.instead_of(1), "; heard instead: CAN node 2, 12");
  EXPECT_EQ(nodes.instead_of(12), "");
  nodes.forget();
  EXPECT_EQ(nodes.instead_of(1), "");
}

TEST(NodesHeard, ASourceMustPassTheHeartbeatsOfAllNodes) {
  const auto ids = canopen::NodesHeard::ids();
  EXPECT_EQ(ids.size(), 127u);
  EXPECT_EQ(ids.front(), 0x701u);
  EXPECT_EQ(ids.back(), 0x77Fu);
}

}  // namespace
}  // namespace curbstone::encoder
