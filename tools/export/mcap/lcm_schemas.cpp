#include "tools/export/mcap/lcm_schemas.hpp"

#include <set>

#include "common/message_types/built_in_types.hpp"
#include "common/message_types/type_parser.hpp"
#include "common/message_types/type_table.hpp"

namespace curbstone::map_export::mcap {
namespace {

void add_text(const std::map<std::string, std::string>& texts, const MessageType& type, std::set<std::string>& added,
              std::string& text) {
  const auto own = texts.find(type.name);
  if (own == texts.end() || !added.insert(type.name).second) return;
  text += own->second;
  for (const MessageField& field : type.fields) {
    if (const MessageType* held = TypeTable::built_in().find(field.type)) add_text(texts, *held, added, text);
  }
}

}  // namespace

LcmSchemas::LcmSchemas() {
  for (const std::string_view text : built_in_type_texts()) {
    for (const MessageType& type : parse_message_types(text)) texts_.emplace(type.name, text);
  }
}

std::optional<McapSchema> LcmSchemas::of(const void* message, std::size_t size) const {
  const MessageType* type = TypeTable::built_in().type_of(message, size);
  if (type == nullptr) return std::nullopt;
  std::set<std::string> added;
  std::string text;
  add_text(texts_, *type, added, text);
  return McapSchema{type->name, "lcm", text};
}

}  // namespace curbstone::map_export::mcap
