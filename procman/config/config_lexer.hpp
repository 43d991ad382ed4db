#pragma once

#include <string>
#include <string_view>

namespace curbstone::procman::config {

enum class TokenKind { kEnd, kName, kString, kInteger, kPunctuation };

struct Token {
  TokenKind kind = TokenKind::kEnd;
  std::string text;  ///< contents of a string with the escapes resolved
  int line = 1;      ///< from 1
  int column = 1;    ///< from 1, in bytes
};

/// Splits a .cfg text into tokens, and composes the error messages. The text must outlive it.
class ConfigLexer {
 public:
  ConfigLexer(std::string_view text, std::string file);

  /// The next token, without consuming it.
  [[nodiscard]] const Token& peek();
  Token take();

  /// Throws ConfigSyntaxError at a token, with position, message, source line and caret.
  [[noreturn]] void fail(const Token& at, const std::string& message) const;

 private:
  void skip_blanks_and_comments();
  Token scan();
  Token scan_string();
  [[nodiscard]] Token here() const;
  char advance();

  std::string_view text_;
  std::string file_;
  std::size_t position_ = 0;
  int line_ = 1;
  int column_ = 1;
  Token next_;
  bool has_next_ = false;
};

/// A token as named in errors: "'}'", "the end of the file", "the string "x"".
[[nodiscard]] std::string describe(const Token& token);

}  // namespace curbstone::procman::config
