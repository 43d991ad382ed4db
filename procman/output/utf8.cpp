#include "procman/output/utf8.hpp"

namespace curbstone::procman::output {

namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

enum class Validity { kValid, kInvalid, kIncomplete };
struct Character {
  Validity validity;
  std::size_t size;  // bytes to take
};

/// The character at the beginning of `bytes`, by the table of well-formed byte sequences (Unicode 15, table 3-7).
Character character(std::string_view bytes) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  const unsigned char first = byte(0);
  if (first == 0) return {Validity::kInvalid, 1};
  if (first < 0x80) return {Validity::kValid, 1};
  if (first < 0xC2 || first > 0xF4) return {Validity::kInvalid, 1};
  const std::size_t size = first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  for (std::size_t i = 1; i < size; ++i) {
    if (i == bytes.size()) return {Validity::kIncomplete, i};
    unsigned char low = 0x80;
    unsigned char high = 0xBF;
    if (i == 1) {
      if (first == 0xE0) low = 0xA0;   // no overlong forms
      if (first == 0xED) high = 0x9F;  // no surrogates
      if (first == 0xF0) low = 0x90;
      if (first == 0xF4) high = 0x8F;  // up to U+10FFFF
    }
    if (byte(i) < low || byte(i) > high) return {Validity::kInvalid, i};
  }
  return {Validity::kValid, size};
}

}  // namespace

std::string Utf8Stream::feed(std::string_view bytes) {
  const std::string all = std::move(held_) + std::string(bytes);
  held_.clear();
  std::string text;
  text.reserve(all.size());
  for (std::size_t at = 0; at < all.size();) {
    const auto [validity, size] = character(std::string_view(all).substr(at));
    if (validity == Validity::kIncomplete) {
      held_ = all.substr(at);
      break;
    }
    text += validity == Validity::kValid ? std::string_view(all).substr(at, size) : kReplacement;
    at += size;
  }
  return text;
}

}  // namespace curbstone::procman::output
