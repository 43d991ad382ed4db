#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "services/tensor_voting/cuda/warp_gather.hpp"

namespace curbstone::tensor_voting::cuda {

/// A warp in the host's place: lane after lane, in an order that a device would not choose; what a lane reads of the
/// others before sync() would be seen to be wrong.
struct HostWarp {
  template <class T>
  using Lanes = std::array<T, kWarp>;

  template <class F>
  void each(const F& f) const {
    for (std::uint32_t lane = kWarp; lane-- > 0;) f(lane);
  }
  void sync() const {}
};

/// A GPU's part played by the host, one thing after the other.
struct HostMachine {
  template <class T>
  using Array = std::vector<T>;

  std::size_t most_elements = 0;  ///< of an array, if not 0: larger ones are out of memory

  template <class T>
  Array<T> allocate(std::size_t n) const {
    if (most_elements != 0 && n > most_elements) throw std::runtime_error("out of memory");
    Array<T> array(n);
    if (n > 0) std::memset(static_cast<void*>(array.data()), 0xa5, n * sizeof(T));  // a device's memory is not empty
    return array;
  }
  template <class T>
  Array<T> upload(const T* from, std::size_t n) const {
    return Array<T>(from, from + n);
  }
  template <class T>
  void download(const Array<T>& from, std::size_t n, T* to) const {
    std::copy_n(from.begin(), n, to);
  }
  template <class T>
  void copy(const Array<T>& from, std::size_t n, Array<T>& to) const {
    std::copy_n(from.begin(), n, to.begin());
  }
  template <class T>
  void zero(Array<T>& array, std::size_t n) const {
    std::fill_n(array.begin(), n, T{});
  }
  void sort(Array<std::uint64_t>& keys, Array<std::uint32_t>& values, std::uint32_t n) const {
    std::vector<std::uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return keys[a] < keys[b]; });
    const auto old_keys = keys;
    const auto old_values = values;
    for (std::uint32_t i = 0; i < n; ++i) {
      keys[i] = old_keys[order[i]];
      values[i] = old_values[order[i]];
    }
  }
  template <class F>
  void for_each(std::uint32_t n, const F& f) const {
    for (std::uint32_t i = 0; i < n; ++i) f(i);
  }
  template <class F>
  void for_each_window(std::uint32_t n, const F& f) const {
    typename F::Memory memory{};
    for (std::uint32_t window = n; window-- > 0;) {
      HostWarp warp;
      f(warp, memory, window);
    }
  }
};

}  // namespace curbstone::tensor_voting::cuda
