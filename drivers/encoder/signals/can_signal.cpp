#include "drivers/encoder/signals/can_signal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "drivers/encoder/can/hex.hpp"

namespace curbstone::encoder::signals {

namespace {

constexpr int kBits = 64;
constexpr std::string_view kBlanks = " \t";

/// Parses a signal's text from the left.
class Text {
 public:
  explicit Text(std::string_view text) : text_(text), rest_(text) {}

  [[noreturn]] void fail(std::string_view why) const {
    throw std::runtime_error(fmt::format("\"{}\": {}; expected e.g. \"181 0|32@1- (1,0)\"", text_, why));
  }
  void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlanks), rest_.size())); }
  [[nodiscard]] bool empty() const { return rest_.empty(); }
  /// Blanks before it do not matter.
  bool take(char c) {
    skip_blanks();
    if (rest_.empty() || rest_[0] != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void expect(char c) {
    if (!take(c)) fail(fmt::format("'{}' is missing", c));
  }
  std::string_view word() {
    const std::string_view word = rest_.substr(0, rest_.find_first_of(kBlanks));
    rest_.remove_prefix(word.size());
    return word;
  }
  template <class Number>
  Number number(const char* what) {
    skip_blanks();
    Number value{};
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error != std::errc{}) fail(fmt::format("{} is no number", what));
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }

 private:
  std::string_view text_, rest_;
};

/// Bit number counted from the front of the frame: bit 7 of byte 0 is 0, its bit 0 is 7.
int from_front(int bit) {
  return bit / 8 * 8 + 7 - bit % 8;
}

/// Bit k of the result is bit k of the frame, numbered as in a DBC file.
std::uint64_t bits_of(const CanSignal& signal) {
  std::uint64_t bits = 0;
  for (int i = 0; i < signal.length; ++i) {
    // from_front() is its own inverse.
    const int bit = signal.big_endian ? from_front(from_front(signal.start) + i) : signal.start + i;
    bits |= std::uint64_t{1} << bit;
  }
  return bits;
}

/// One past the last bit, in a numbering with eight consecutive bits per byte.
int end_bit(const CanSignal& signal) {
  return (signal.big_endian ? from_front(signal.start) : signal.start) + signal.length;
}

}  // namespace

CanSignal CanSignal::parse(std::string_view text) {
  CanSignal signal;
  Text rest(text);
  rest.skip_blanks();
  std::string_view id = rest.word();
  if (id.starts_with("0x") || id.starts_with("0X")) id.remove_prefix(2);
  const auto number = can::parse_hex(id);
  signal.extended = id.size() == 8;
  if (!number || (id.size() > 3 && !signal.extended) ||
      *number > (signal.extended ? can::kMaxExtendedId : can::kMaxStandardId)) {
    rest.fail("the id has 1 to 3 hexadecimal digits, up to 7FF, or 8, up to 1FFFFFFF");
  }
  signal.id = *number;
  signal.start = rest.number<int>("the start bit");
  rest.expect('|');
  signal.length = rest.number<int>("the length");
  rest.expect('@');
  const int order = rest.number<int>("the byte order");
  if (order != 0 && order != 1) rest.fail("the byte order is 1 (little-endian) or 0 (big-endian)");
  signal.big_endian = order == 0;
  signal.is_signed = !rest.take('+');
  if (signal.is_signed) rest.expect('-');
  if (rest.take('(')) {
    signal.factor = rest.number<double>("the factor");
    rest.expect(',');
    signal.offset = rest.number<double>("the offset");
    rest.expect(')');
  }
  rest.skip_blanks();
  if (!rest.empty()) rest.fail("something follows");
  if (signal.start < 0 || signal.start >= kBits || signal.length < 1 || signal.length > kBits ||
      end_bit(signal) > kBits) {
    rest.fail("it does not fit into the 64 bits of a frame");
  }
  if (!std::isfinite(signal.factor) || signal.factor == 0 || !std::isfinite(signal.offset))
    rest.fail("factor and offset are numbers, the factor is not 0");
  return signal;
}

std::optional<std::int64_t> CanSignal::raw(const can::CanFrame& frame) const {
  if (frame.remote || 8 * frame.size < end_bit(*this)) return {};
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < 8; ++i) bits = bits << 8 | frame.data[big_endian ? i : 7 - i];
  // Shift up to the left end, which cuts off the bits above, then down to the right end.
  const int above = big_endian ? from_front(start) : kBits - start - length;
  bits <<= above;
  const int below = kBits - length;
  return is_signed ? static_cast<std::int64_t>(bits) >> below : static_cast<std::int64_t>(bits >> below);
}

bool CanSignal::overlaps(const CanSignal& other) const {
  return id == other.id && extended == other.extended && (bits_of(*this) & bits_of(other)) != 0;
}

double CanSignal::value(std::int64_t number) const {
  const double whole =
      is_signed ? static_cast<double>(number) : static_cast<double>(static_cast<std::uint64_t>(number));
  return whole * factor + offset;
}

}  // namespace curbstone::encoder::signals
