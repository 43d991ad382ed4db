#pragma once

#include <cstddef>
#include <cstdint>
#include <ranges>
#include <span>
#include <type_traits>
#include <vector>

namespace curbstone {

/// Compressed values.
using PackedValues = std::vector<std::byte>;

/// Compresses values that a process keeps but does not use for now; ValueUnpacker restores every bit. This is not a
/// file format: only the program that packed the values reads them.
class ValuePacker {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(!std::ranges::range<T>, "a span would be packed as a pointer; put_all() packs what it shows");
    put_all(std::span<const T>(&value, 1));
  }
  /// Puts values without their number, as byte planes: the first bytes of all values, then the second ones, and so on.
  /// The high bytes of similar numbers then lie together and compress well.
  template <class T>
  void put_all(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    put_planes(reinterpret_cast<const std::byte*>(values.data()), values.size(), sizeof(T));
  }
  template <class T>
  void put(const std::vector<T>& values) {
    put(static_cast<std::uint64_t>(values.size()));
    put_all(std::span<const T>(values));
  }

  /// Puts one field of all values, with their number, as differences between neighbours, which compress well where
  /// neighbours are similar.
  template <class T, class Field>
  void put_steps(const std::vector<T>& values, Field T::*field) {
    using Step = std::make_unsigned_t<Field>;
    std::vector<Step> steps;
    steps.reserve(values.size());
    Step last = 0;
    for (const T& value : values) {
      const auto now = static_cast<Step>(value.*field);
      steps.push_back(static_cast<Step>(now - last));
      last = now;
    }
    put(steps);
  }

  /// Compresses everything that was put. Throws std::bad_alloc.
  [[nodiscard]] PackedValues pack() const;

 private:
  void put_planes(const std::byte* values, std::size_t count, std::size_t size);
  std::vector<std::byte> bytes_;
};

/// Reads values in the order in which they were put.
class ValueUnpacker {
 public:
  /// Throws std::runtime_error if the bytes are not packed values.
  explicit ValueUnpacker(std::span<const std::byte> packed);

  template <class T>
  [[nodiscard]] T take() {
    T value{};
    take_all(std::span<T>(&value, 1));
    return value;
  }
  /// Reads as many values as the span has room for.
  template <class T>
  void take_all(std::span<T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    take_planes(reinterpret_cast<std::byte*>(values.data()), values.size(), sizeof(T));
  }
  template <class T>
  void take(std::vector<T>& values) {
    values.resize(take_count(sizeof(T)));
    take_all(std::span<T>(values));
  }
  /// Reads what put_steps() put, into as many values.
  template <class T, class Field>
  void take_steps(std::vector<T>& values, Field T::*field) {
    using Step = std::make_unsigned_t<Field>;
    std::vector<Step> steps;
    take(steps);
    values.resize(steps.size());
    Step now = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      now = static_cast<Step>(now + steps[i]);
      values[i].*field = static_cast<Field>(now);
    }
  }

 private:
  [[nodiscard]] std::size_t take_count(std::size_t size);
  void take_planes(std::byte* values, std::size_t count, std::size_t size);
  std::vector<std::byte> bytes_;
  std::size_t at_ = 0;
};

}  // namespace curbstone
