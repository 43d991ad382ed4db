#include "common/message_types/type_parser.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>

namespace curbstone {

namespace {

constexpr std::array<std::string_view, 9> kPrimitives = {"int8_t", "int16_t", "int32_t", "int64_t", "byte",
                                                         "float",  "double",  "string",  "boolean"};

/// Splits the text into words and punctuation, without comments.
class TypeTokens {
 public:
  explicit TypeTokens(std::string_view text) : text_(text) { advance(); }

  [[nodiscard]] bool at_end() const { return token_.empty(); }
  [[nodiscard]] bool at(std::string_view token) const { return token_ == token; }
  std::string take() {
    if (at_end()) fail("the text ends in the middle of a definition");
    std::string taken(token_);
    advance();
    return taken;
  }
  bool take_if(std::string_view token) {
    if (!at(token)) return false;
    advance();
    return true;
  }
  void expect(std::string_view token) {
    if (!take_if(token)) fail(fmt::format("expected '{}', found '{}'", token, token_));
  }
  std::string word(std::string_view what) {
    if (at_end() || !is_word(token_[0])) fail(fmt::format("expected {}, found '{}'", what, token_));
    return take();
  }
  [[noreturn]] void fail(const std::string& what) const {
    const auto line = std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(begin_), '\n') + 1;
    throw std::runtime_error(fmt::format("line {}: {}", line, what));
  }

 private:
  static bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

  void advance() {
    skip_blanks();
    begin_ = at_;
    if (at_ < text_.size()) ++at_;
    if (at_ > begin_ && is_word(text_[begin_])) {
      while (at_ < text_.size() && (is_word(text_[at_]) || text_[at_] == '.')) ++at_;
    }
    token_ = text_.substr(begin_, at_ - begin_);
  }
  void skip_blanks() {
    while (at_ < text_.size()) {
      if (std::isspace(static_cast<unsigned char>(text_[at_])) != 0) {
        ++at_;
      } else if (text_.substr(at_, 2) == "//") {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (text_.substr(at_, 2) == "/*") {
        const auto end = text_.find("*/", at_ + 2);
        at_ = end == std::string_view::npos ? text_.size() : end + 2;
      } else {
        return;
      }
    }
  }

  std::string_view text_;
  std::string_view token_;
  std::size_t begin_ = 0;
  std::size_t at_ = 0;
};

std::vector<ArrayLength> dimensions(TypeTokens& tokens) {
  std::vector<ArrayLength> lengths;
  while (tokens.take_if("[")) {
    ArrayLength length{tokens.word("the length of an array")};
    length.fixed = std::isdigit(static_cast<unsigned char>(length.text[0])) != 0;
    const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
    if (length.fixed && (length.text.size() > 9 || !std::all_of(length.text.begin(), length.text.end(), is_digit)))
      tokens.fail(fmt::format("'{}' is no length of an array", length.text));
    lengths.push_back(length);
    tokens.expect("]");
  }
  return lengths;
}

std::string full_name(const std::string& package, const std::string& name) {
  return package.empty() || name.find('.') != std::string::npos ? name : package + "." + name;
}

void read_member(TypeTokens& tokens, const std::string& package, MessageType& type) {
  if (tokens.take_if("const")) {
    while (!tokens.take_if(";")) tokens.take();
    return;
  }
  const std::string written = tokens.word("a type");
  const std::string of = is_primitive(written) ? written : full_name(package, written);
  do {
    const std::string name = tokens.word("the name of a field");
    type.fields.push_back({name, of, dimensions(tokens)});
  } while (tokens.take_if(","));
  tokens.expect(";");
}

}  // namespace

bool is_primitive(const std::string& type) {
  return std::find(kPrimitives.begin(), kPrimitives.end(), type) != kPrimitives.end();
}

std::vector<MessageType> parse_message_types(std::string_view text) {
  TypeTokens tokens(text);
  std::vector<MessageType> types;
  std::string package;
  while (!tokens.at_end()) {
    if (tokens.take_if("package")) {
      package = tokens.word("the name of a package");
      tokens.expect(";");
      continue;
    }
    tokens.expect("struct");
    MessageType type{full_name(package, tokens.word("the name of a type")), {}};
    tokens.expect("{");
    while (!tokens.take_if("}")) read_member(tokens, package, type);
    types.push_back(std::move(type));
  }
  return types;
}

}  // namespace curbstone
