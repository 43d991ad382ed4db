#include "services/viewer/page_request.hpp"

#include <limits>
#include <nlohmann/json.hpp>

#include "common/json/json_text.hpp"

namespace curbstone::viewer {
namespace {

using nlohmann::json;

std::optional<double> number_in(const json& object, const char* name) {
  const auto it = object.find(name);
  if (it == object.end() || !it->is_number()) return std::nullopt;
  return it->get<double>();
}

std::optional<bool> flag_in(const json& object, const char* name) {
  const auto it = object.find(name);
  if (it == object.end() || !it->is_boolean()) return std::nullopt;
  return it->get<bool>();
}

/// A number from 0 to `most`.
std::optional<double> whole_in(const json& object, const char* name, double most) {
  const auto number = number_in(object, name);
  return number && *number >= 0 && *number <= most ? number : std::nullopt;
}

std::optional<frames::PageFeed::Resume> resume_in(const json& message) {
  if (!message.is_object()) return std::nullopt;
  const auto epoch = whole_in(message, "epoch", std::numeric_limits<std::int32_t>::max());
  const auto number = whole_in(message, "number", 1e15);
  if (!epoch || !number) return std::nullopt;
  return frames::PageFeed::Resume{.run = number_in(message, "run").value_or(-1),
                                  .epoch = static_cast<std::int32_t>(*epoch),
                                  .number = static_cast<std::uint64_t>(*number)};
}

std::optional<PlaybackCommand> command_in(const json& message) {
  if (!message.is_object()) return std::nullopt;
  const PlaybackCommand command{.pause = flag_in(message, "pause"),
                                .speed = number_in(message, "speed"),
                                .position = number_in(message, "position")};
  if (command.speed && !(*command.speed > 0)) return std::nullopt;
  if (command.position && !(*command.position >= 0)) return std::nullopt;
  return command;
}

/// A place in map, m.
std::optional<std::pair<double, double>> place_in(const json& object, const char* name) {
  const auto it = object.find(name);
  if (it == object.end() || !it->is_array() || it->size() != 2 || !(*it)[0].is_number() || !(*it)[1].is_number())
    return std::nullopt;
  return std::pair{(*it)[0].get<double>(), (*it)[1].get<double>()};
}

std::optional<frames::CloudWish> cloud_in(const json& message) {
  if (!message.is_object()) return std::nullopt;
  return frames::CloudWish{.wide = flag_in(message, "wide").value_or(false),
                           .saliency = flag_in(message, "saliency").value_or(false),
                           .cut = place_in(message, "cut")};
}

}  // namespace

PageRequest parse_page_request(const std::string& text) {
  PageRequest request;
  const json message = try_parse_json(text);
  if (!message.is_object()) return request;
  if (const auto resume = message.find("resume"); resume != message.end()) {
    request.resumes = true;
    request.has = resume_in(*resume);
  }
  if (const auto frame = whole_in(message, "ack", std::numeric_limits<std::uint32_t>::max()))
    request.drawn = static_cast<std::uint32_t>(*frame);
  if (const auto play = message.find("play"); play != message.end()) request.play = command_in(*play);
  request.points = flag_in(message, "points");
  if (const auto cloud = message.find("cloud"); cloud != message.end()) request.cloud = cloud_in(*cloud);
  return request;
}

}  // namespace curbstone::viewer
