#include "services/viewer/page_words.hpp"

#include <limits>
#include <nlohmann/json.hpp>

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

std::optional<frames::PageFeed::Resume> resume_in(const json& said) {
  if (!said.is_object()) return std::nullopt;
  const auto epoch = whole_in(said, "epoch", std::numeric_limits<std::int32_t>::max());
  const auto number = whole_in(said, "number", 1e15);
  if (!epoch || !number) return std::nullopt;
  return frames::PageFeed::Resume{.run = number_in(said, "run").value_or(-1),
                                  .epoch = static_cast<std::int32_t>(*epoch),
                                  .number = static_cast<std::uint64_t>(*number)};
}

std::optional<PlayOrder> order_in(const json& said) {
  if (!said.is_object()) return std::nullopt;
  const PlayOrder order{
      .pause = flag_in(said, "pause"), .speed = number_in(said, "speed"), .position = number_in(said, "position")};
  if (order.speed && !(*order.speed > 0)) return std::nullopt;
  if (order.position && !(*order.position >= 0)) return std::nullopt;
  return order;
}

}  // namespace

PageWords read_page_words(const std::string& text) {
  PageWords words;
  const json said = json::parse(text, nullptr, false);
  if (!said.is_object()) return words;
  if (const auto resume = said.find("resume"); resume != said.end()) {
    words.resumes = true;
    words.has = resume_in(*resume);
  }
  if (const auto frame = whole_in(said, "ack", std::numeric_limits<std::uint32_t>::max()))
    words.drawn = static_cast<std::uint32_t>(*frame);
  if (const auto play = said.find("play"); play != said.end()) words.play = order_in(*play);
  words.points = flag_in(said, "points");
  return words;
}

}  // namespace curbstone::viewer
