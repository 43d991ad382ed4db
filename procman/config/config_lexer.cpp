#include "procman/config/config_lexer.hpp"

#include <fmt/format.h>

#include "procman/config/config.hpp"

namespace curbstone::procman::config {

namespace {

constexpr std::string_view kDigits = "0123456789";
constexpr std::string_view kNameStart = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_";
constexpr std::string_view kNameRest = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789-";

bool is_in(char c, std::string_view set) {
  return set.find(c) != std::string_view::npos;
}

}  // namespace

std::string describe(const Token& token) {
  switch (token.kind) {
    case TokenKind::kEnd:
      return "the end of the file";
    case TokenKind::kString:
      return fmt::format("the string \"{}\"", token.text);
    default:
      return fmt::format("'{}'", token.text);
  }
}

ConfigLexer::ConfigLexer(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // some editors write it
  if (text_.starts_with(kByteOrderMark)) text_.remove_prefix(kByteOrderMark.size());
}

const Token& ConfigLexer::peek() {
  if (!has_next_) {
    next_ = scan();
    has_next_ = true;
  }
  return next_;
}

Token ConfigLexer::take() {
  Token token = peek();
  has_next_ = false;
  return token;
}

void ConfigLexer::fail(const Token& at, const std::string& message) const {
  std::size_t begin = 0;
  for (int line = 1; line < at.line; ++line) begin = text_.find('\n', begin) + 1;
  std::string_view source = text_.substr(begin, text_.find('\n', begin) - begin);
  if (source.ends_with('\r')) source.remove_suffix(1);
  std::string margin;  // tabs are kept, so that the caret is below the position
  for (int i = 0; i + 1 < at.column && static_cast<std::size_t>(i) < source.size(); ++i) {
    margin += source[static_cast<std::size_t>(i)] == '\t' ? '\t' : ' ';
  }
  throw ConfigSyntaxError(fmt::format("{}:{}:{}: {}\n  {}\n  {}^", file_, at.line, at.column, message, source, margin),
                          at.line, at.column);
}

Token ConfigLexer::here() const {
  return {TokenKind::kPunctuation, {}, line_, column_};
}

char ConfigLexer::advance() {
  const char c = text_[position_++];
  if (c == '\n') {
    ++line_;
    column_ = 1;
  } else {
    ++column_;
  }
  return c;
}

void ConfigLexer::skip_blanks_and_comments() {
  while (position_ < text_.size()) {
    if (text_[position_] == '#') {
      while (position_ < text_.size() && text_[position_] != '\n') advance();
    } else if (is_in(text_[position_], " \t\r\n")) {
      advance();
    } else {
      return;
    }
  }
}

Token ConfigLexer::scan() {
  skip_blanks_and_comments();
  Token token = here();
  if (position_ >= text_.size()) {
    token.kind = TokenKind::kEnd;
    return token;
  }
  const char c = text_[position_];
  if (c == '"') return scan_string();
  const bool is_name = is_in(c, kNameStart);
  if (is_name || is_in(c, kDigits)) {
    token.kind = is_name ? TokenKind::kName : TokenKind::kInteger;
    while (position_ < text_.size() && is_in(text_[position_], is_name ? kNameRest : kDigits)) token.text += advance();
    return token;
  }
  if (!is_in(c, "{}=;")) {
    const auto byte = static_cast<unsigned char>(c);
    fail(token, byte > 32 && byte < 127 ? fmt::format("unexpected character '{}'", c)
                                        : fmt::format("unexpected byte 0x{:02x}", byte));
  }
  token.text = advance();
  return token;
}

Token ConfigLexer::scan_string() {
  Token token = here();
  token.kind = TokenKind::kString;
  advance();
  while (position_ < text_.size() && text_[position_] != '\n') {
    const char c = advance();
    if (c == '"') return token;
    if (c == '\0') fail(token, "a string cannot hold a zero byte");
    if (c != '\\') {
      token.text += c;
      continue;
    }
    if (position_ >= text_.size() || text_[position_] == '\n') break;
    const char escaped = advance();
    token.text += escaped == 'n' ? '\n' : escaped == 'r' ? '\r' : escaped == 't' ? '\t' : escaped;
  }
  fail(token, "this string has no closing quote on its line");
}

}  // namespace curbstone::procman::config
