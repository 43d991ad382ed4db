#pragma once

#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

namespace curbstone::mapper::journal {

/// Appends a value as it lies in memory: the files are read on the host that wrote them.
template <class Value>
void append_value(std::string& out, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Reads the bytes of a batch from left to right. Throws std::runtime_error at their end.
class BatchBytes {
 public:
  explicit BatchBytes(std::string_view bytes) : rest_(bytes) {}
  [[nodiscard]] bool empty() const { return rest_.empty(); }
  [[nodiscard]] std::size_t size() const { return rest_.size(); }

  template <class Value>
  [[nodiscard]] Value take() {
    static_assert(std::is_trivially_copyable_v<Value>);
    Value value;
    std::memcpy(&value, take_bytes(sizeof value).data(), sizeof value);
    return value;
  }
  [[nodiscard]] std::string_view take_bytes(std::size_t size) {
    if (size > rest_.size()) throw std::runtime_error("ends within an item");
    const std::string_view bytes = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return bytes;
  }

 private:
  std::string_view rest_;
};

}  // namespace curbstone::mapper::journal
