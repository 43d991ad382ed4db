#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/viewer/foxglove/topics.hpp"

namespace curbstone::viewer::foxglove {

/// @file
/// The Foxglove WebSocket protocol, version 1, as far as a server without capabilities needs it: text messages are JSON
/// with `op`, data is binary and little-endian. (foxglove/ws-protocol, docs/spec.md, before July 2025.)

/// What a client offers in Sec-WebSocket-Protocol; both mean the same.
inline constexpr std::string_view kSubprotocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};

/// `session`: another one for each run of the process.
[[nodiscard]] std::string server_info(const std::string& name, const std::string& session);
[[nodiscard]] std::string advertise(const std::vector<Channel>& channels);
/// Something that the client did wrong, for people.
[[nodiscard]] std::string warning(const std::string& text);

/// Data for a client's subscription. `utime`: us since the Unix epoch, of sending.
[[nodiscard]] std::vector<std::uint8_t> data_frame(std::uint32_t subscription, std::int64_t utime,
                                                   std::string_view payload);

/// What a client asked for.
struct ClientRequest {
  struct Subscription {
    std::uint32_t id = 0;  ///< the client's; not the channel's
    std::uint32_t channel = 0;
  };
  std::vector<Subscription> subscribe;
  std::vector<std::uint32_t> unsubscribe;  ///< ids of subscriptions
};
/// Nothing: it is neither of the two, or not sound.
[[nodiscard]] std::optional<ClientRequest> parse_request(std::string_view text);

}  // namespace curbstone::viewer::foxglove
