#include "services/viewer/foxglove/wire.hpp"

#include <limits>
#include <nlohmann/json.hpp>

#include "common/json/json_text.hpp"
#include "services/viewer/frames/byte_writer.hpp"

namespace curbstone::viewer::foxglove {
namespace {

using nlohmann::json;

constexpr std::uint8_t kData = 1;
constexpr int kWarning = 1;  // level of a status: 0 info .. 2 error

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::optional<std::uint32_t> id_of(const json& value) {
  if (!value.is_number_integer()) return std::nullopt;
  const auto number = value.get<std::int64_t>();
  if (number < 0 || number > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<std::uint32_t>(number);
}

/// Empty: there is no valid id under `name`.
std::optional<std::uint32_t> id_in(const json& object, const char* name) {
  if (!object.is_object()) return std::nullopt;
  const auto it = object.find(name);
  return it == object.end() ? std::nullopt : id_of(*it);
}

}  // namespace

std::string server_info(const std::string& name, const std::string& session) {
  return json_text({{"op", "serverInfo"}, {"name", name}, {"capabilities", json::array()}, {"sessionId", session}});
}

std::string advertise(const std::vector<Channel>& channels) {
  json list = json::array();
  for (const Channel& channel : channels) {
    const bool is_binary = channel.schema_encoding == "protobuf";
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", channel.encoding},
                    {"schemaName", channel.schema_name},
                    {"schema", is_binary ? base64(channel.schema) : channel.schema},
                    {"schemaEncoding", channel.schema_encoding}});
  }
  return json_text({{"op", "advertise"}, {"channels", list}});
}

std::string warning(const std::string& text) {
  return json_text({{"op", "status"}, {"level", kWarning}, {"message", text}});
}

std::vector<std::uint8_t> data_frame(std::uint32_t subscription, std::int64_t utime, std::string_view payload) {
  frames::ByteWriter out;
  const auto ns = static_cast<std::uint64_t>(utime) * 1000;
  out.u8(kData);
  out.u32(subscription);
  out.u32(static_cast<std::uint32_t>(ns));
  out.u32(static_cast<std::uint32_t>(ns >> 32));
  out.text(payload);
  return out.take();
}

std::optional<ClientRequest> parse_request(std::string_view text) {
  const json said = try_parse_json(text);
  if (!said.is_object()) return std::nullopt;
  const std::string op = said.value("op", json()).is_string() ? said.at("op").get<std::string>() : "";
  const char* list_name = op == "subscribe" ? "subscriptions" : "subscriptionIds";
  if (op != "subscribe" && op != "unsubscribe") return std::nullopt;
  const auto list = said.find(list_name);
  if (list == said.end() || !list->is_array()) return std::nullopt;
  ClientRequest request;
  for (const json& entry : *list) {
    if (op == "unsubscribe") {
      const auto id = id_of(entry);
      if (!id) return std::nullopt;
      request.unsubscribe.push_back(*id);
      continue;
    }
    const auto id = id_in(entry, "id");
    const auto channel = id_in(entry, "channelId");
    if (!id || !channel) return std::nullopt;
    request.subscribe.push_back({*id, *channel});
  }
  return request;
}

}  // namespace curbstone::viewer::foxglove
