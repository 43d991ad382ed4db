#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/viewer/foxglove/topics.hpp"

namespace curbstone::viewer::foxglove {

/// @file
/// The Foxglove WebSocket protocol, version 1, limited to what a server without capabilities needs: text messages are
/// JSON with `op`; data is binary and little-endian. (foxglove/ws-protocol, docs/spec.md, before July 2025.)

/// The names that a client may offer in Sec-WebSocket-Protocol; both stand for the same protocol.
inline constexpr std::string_view kSubprotocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};

/// `session`: unique for each run of the process.
[[nodiscard]] std::string server_info(const std::string& name, const std::string& session);
[[nodiscard]] std::string advertise(const std::vector<Channel>& channels);
/// A message for people about an error of the client.
[[nodiscard]] std::string warning(const std::string& text);

/// Data for a client's subscription. `utime`: us since the Unix epoch, when it is sent.
[[nodiscard]] std::vector<std::uint8_t> data_frame(std::uint32_t subscription, std::int64_t utime,
                                                   std::string_view payload);

/// A subscribe or unsubscribe request of a client.
struct ClientRequest {
  struct Subscription {
    std::uint32_t id = 0;  ///< chosen by the client; not the channel's
    std::uint32_t channel = 0;
  };
  std::vector<Subscription> subscribe;
  std::vector<std::uint32_t> unsubscribe;  ///< ids of subscriptions
};
/// Empty: `text` is neither of the two requests, or it is invalid.
[[nodiscard]] std::optional<ClientRequest> parse_request(std::string_view text);

}  // namespace curbstone::viewer::foxglove
