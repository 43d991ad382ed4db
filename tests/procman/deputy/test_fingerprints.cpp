#include <gtest/gtest.h>

#include <procman_lcm/cmd_desired_t.hpp>
#include <procman_lcm/cmd_status_t.hpp>
#include <procman_lcm/cmd_t.hpp>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>
#include <procman_lcm/output_t.hpp>

namespace {

template <class Message>
std::uint64_t fingerprint() {
  return static_cast<std::uint64_t>(Message::getHash());
}

/// Computed by Debian's lcm-gen 1.3.1 from procman's own definitions: field order and types decide.
TEST(ProcmanTypes, HaveTheFingerprintsOfTheUpstreamWireFormat) {
  EXPECT_EQ(fingerprint<procman_lcm::cmd_t>(), 0x2277f449a855d330U);
  EXPECT_EQ(fingerprint<procman_lcm::cmd_desired_t>(), 0xb2a6c7a09ba54539U);
  EXPECT_EQ(fingerprint<procman_lcm::cmd_status_t>(), 0xa8e0208786cf86e3U);
  EXPECT_EQ(fingerprint<procman_lcm::deputy_info_t>(), 0x8876aeb040efd01fU);
  EXPECT_EQ(fingerprint<procman_lcm::orders_t>(), 0xd343f45b171ab855U);
  EXPECT_EQ(fingerprint<procman_lcm::output_t>(), 0x8efa5caf5da01eb3U);
  EXPECT_EQ(fingerprint<procman_lcm::discovery_t>(), 0xb1c83182bed74b95U);
}

}  // namespace
