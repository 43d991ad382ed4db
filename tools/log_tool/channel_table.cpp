#include "tools/log_tool/channel_table.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <utility>

namespace curbstone::log_tool {

namespace {

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

/// The top-level field: "x" for "x[3]" and for "x.y[3]".
std::string top_field(const std::string& name) {
  return name.substr(0, name.find_first_of(".["));
}

}  // namespace

void ChannelTable::begin(const MessageType& type) {
  type_ = &type;
  std::string shared_length;
  for (const MessageField& field : type.fields) {
    const auto is_variable = [](const ArrayLength& length) { return !length.fixed; };
    if (std::none_of(field.dimensions.begin(), field.dimensions.end(), is_variable)) continue;
    variable_.insert(field.name);
    const bool is_list = field.dimensions.size() == 1 && is_primitive(field.type);
    if (shared_length.empty() && is_list) shared_length = field.dimensions[0].text;
    if (elements_ && is_list && field.dimensions[0].text == shared_length) {
      array_columns_.push_back(field.name);
    } else {
      left_out_.insert(field.name);
    }
  }
  arrays_.resize(array_columns_.size());
}

void ChannelTable::write_header(const std::vector<NamedValue>& values) {
  fmt::print(out_, "log_utime");
  for (const NamedValue& value : values) {
    if (!variable_.contains(top_field(value.name))) fmt::print(out_, ",{}", value.name);
  }
  if (elements_) fmt::print(out_, ",element");
  for (const std::string& column : array_columns_) fmt::print(out_, ",{}", column);
  fmt::print(out_, "\n");
}

void ChannelTable::write_row(const LogEvent& event, const std::vector<std::string>& fixed, std::size_t element) {
  fmt::print(out_, "{}", event.log_utime);
  for (const std::string& value : fixed) fmt::print(out_, ",{}", value);
  if (elements_) fmt::print(out_, ",{}", element);
  for (const auto& array : arrays_) fmt::print(out_, ",{}", element < array.size() ? array[element] : "");
  fmt::print(out_, "\n");
  ++rows_;
}

void ChannelTable::write(const LogEvent& event) {
  const TypeTable& table = TypeTable::built_in();
  const auto values = decode_values(table, event.bytes.data(), event.bytes.size());
  const MessageType* type = table.type_of(event.bytes.data(), event.bytes.size());
  if (values && type_ == nullptr) begin(*type);
  if (!values || type != type_) {
    ++undecodable_;
    return;
  }
  if (!std::exchange(header_written_, true)) write_header(*values);
  std::vector<std::string> fixed;
  for (auto& array : arrays_) array.clear();
  for (const NamedValue& value : *values) {
    const std::string field = top_field(value.name);
    if (!variable_.contains(field)) {
      fixed.push_back(quoted(to_text(value.value)));
    } else if (const auto it = std::find(array_columns_.begin(), array_columns_.end(), field);
               it != array_columns_.end()) {
      arrays_[static_cast<std::size_t>(it - array_columns_.begin())].push_back(quoted(to_text(value.value)));
    }
  }
  if (!elements_) {
    write_row(event, fixed, 0);
    return;
  }
  std::size_t longest = 0;
  for (const auto& array : arrays_) longest = std::max(longest, array.size());
  for (std::size_t i = 0; i < longest; ++i) write_row(event, fixed, i);
}

}  // namespace curbstone::log_tool
