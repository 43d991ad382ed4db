#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include "services/tensor_voting/cuda/device_sort.hpp"
#include "services/tensor_voting/cuda/warp_gather.hpp"

namespace curbstone::tensor_voting::cuda {

inline void check(cudaError_t error, const char* what) {
  if (error == cudaSuccess) return;
  throw std::runtime_error(std::string("CUDA: ") + what + ": " + cudaGetErrorName(error) + ", " +
                           cudaGetErrorString(error));
}

/// 32 threads of a block, each of which is a lane.
struct DeviceWarp {
  template <class T>
  struct Lanes {  // the value of this thread
    T value{};
    __device__ T& operator[](std::uint32_t) { return value; }
  };
  template <class F>
  __device__ void each(const F& f) const {
    f(threadIdx.x % kWarp);
  }
  __device__ void sync() const { __syncwarp(); }
};

inline constexpr unsigned kThreads = 128;  // of a block: four independent warps

template <class F>
__global__ void __launch_bounds__(2 * kThreads) run_each(F f, std::uint32_t n) {
  const std::uint64_t i = std::uint64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i < n) f(static_cast<std::uint32_t>(i));
}

template <class F>
__global__ void __launch_bounds__(kThreads) run_each_window(F f, std::uint32_t n) {
  __shared__ typename F::Memory memory[kThreads / kWarp];
  const std::uint64_t window = std::uint64_t{blockIdx.x} * (kThreads / kWarp) + threadIdx.x / kWarp;
  if (window >= n) return;
  DeviceWarp warp;
  f(warp, memory[threadIdx.x / kWarp], static_cast<std::uint32_t>(window));
}

/// The current device, used through a stream and a memory pool of its own. Arrays must not outlive the machine. Work is
/// queued; upload() and download() wait for it. All functions throw std::runtime_error.
class CudaMachine {
  struct Context {
    cudaStream_t stream = nullptr;
    cudaMemPool_t pool = nullptr;
  };

 public:
  CudaMachine() {
    int device = 0;
    check(cudaGetDevice(&device), "no device");
    check(cudaStreamCreateWithFlags(&context_.stream, cudaStreamNonBlocking), "a stream");
    cudaMemPoolProps properties{};
    properties.allocType = cudaMemAllocationTypePinned;
    properties.location.type = cudaMemLocationTypeDevice;
    properties.location.id = device;
    std::uint64_t kept = std::uint64_t{1} << 30;  // bytes kept in the pool from one call to the next
    cudaError_t error = cudaMemPoolCreate(&context_.pool, &properties);
    if (error == cudaSuccess) {
      error = cudaMemPoolSetAttribute(context_.pool, cudaMemPoolAttrReleaseThreshold, &kept);
    }
    if (error != cudaSuccess) {
      release();
      check(error, "a memory pool");
    }
  }
  ~CudaMachine() { release(); }
  CudaMachine(CudaMachine&& other) noexcept : context_(std::exchange(other.context_, {})) {}
  CudaMachine& operator=(CudaMachine&&) = delete;

  template <class T>
  class Array {
   public:
    Array() = default;
    Array(Context context, std::size_t n) : stream_(context.stream) {
      if (n == 0) return;
      void* data = nullptr;
      check(cudaMallocFromPoolAsync(&data, n * sizeof(T), context.pool, stream_),
            ("memory for " + std::to_string(n * sizeof(T)) + " bytes").c_str());
      data_ = static_cast<T*>(data);
    }
    ~Array() { free(); }
    Array(Array&& other) noexcept
        : stream_(std::exchange(other.stream_, nullptr)), data_(std::exchange(other.data_, nullptr)) {}
    Array& operator=(Array&& other) noexcept {
      std::swap(stream_, other.stream_);
      std::swap(data_, other.data_);
      return *this;
    }
    [[nodiscard]] T* data() { return data_; }
    [[nodiscard]] const T* data() const { return data_; }

   private:
    void free() {
      if (data_ != nullptr) cudaFreeAsync(data_, stream_);
    }
    cudaStream_t stream_ = nullptr;
    T* data_ = nullptr;
  };

  template <class T>
  [[nodiscard]] Array<T> allocate(std::size_t n) const {
    return {context_, n};
  }
  template <class T>
  [[nodiscard]] Array<T> upload(const T* from, std::size_t n) const {
    Array<T> to = allocate<T>(n);
    move(to.data(), from, n, cudaMemcpyHostToDevice, "upload");
    synchronize();  // so that the caller may release `from`
    return to;
  }
  template <class T>
  void download(const Array<T>& from, std::size_t n, T* to) const {
    move(to, from.data(), n, cudaMemcpyDeviceToHost, "download");
    synchronize();
  }
  template <class T>
  void copy(const Array<T>& from, std::size_t n, Array<T>& to) const {
    move(to.data(), from.data(), n, cudaMemcpyDeviceToDevice, "copy");
  }
  template <class T>
  void zero(Array<T>& array, std::size_t n) const {
    if (n > 0) check(cudaMemsetAsync(array.data(), 0, n * sizeof(T), context_.stream), "memset");
  }

  void sort(Array<std::uint64_t>& keys, Array<std::uint32_t>& values, std::uint32_t n) const {
    if (n < 2) return;
    Array<std::uint64_t> sorted_keys = allocate<std::uint64_t>(n);
    Array<std::uint32_t> sorted_values = allocate<std::uint32_t>(n);
    const auto run = [&](void* temporary, std::size_t& bytes) {
      check(sort_on_device(temporary, bytes, keys.data(), sorted_keys.data(), values.data(), sorted_values.data(), n,
                           context_.stream),
            "sort");
    };
    std::size_t bytes = 0;
    run(nullptr, bytes);
    Array<char> temporary = allocate<char>(bytes);
    run(temporary.data(), bytes);
    std::swap(keys, sorted_keys);
    std::swap(values, sorted_values);
  }

  template <class F>
  void for_each(std::uint32_t n, const F& f) const {
    if (n == 0) return;
    constexpr unsigned kBlock = 2 * kThreads;
    run_each<<<(n - 1) / kBlock + 1, kBlock, 0, context_.stream>>>(f, n);
    check(cudaGetLastError(), "kernel");
  }
  template <class F>
  void for_each_window(std::uint32_t n, const F& f) const {
    if (n == 0) return;
    constexpr unsigned kWarps = kThreads / kWarp;
    run_each_window<<<(n - 1) / kWarps + 1, kThreads, 0, context_.stream>>>(f, n);
    check(cudaGetLastError(), "kernel");
  }
  void synchronize() const { check(cudaStreamSynchronize(context_.stream), "kernel or copy"); }

 private:
  template <class T>
  void move(T* to, const T* from, std::size_t n, cudaMemcpyKind kind, const char* what) const {
    if (n > 0) check(cudaMemcpyAsync(to, from, n * sizeof(T), kind, context_.stream), what);
  }
  void release() {
    if (context_.stream != nullptr) {
      cudaStreamSynchronize(context_.stream);
      cudaStreamDestroy(context_.stream);
    }
    if (context_.pool != nullptr) cudaMemPoolDestroy(context_.pool);
    context_ = {};
  }

  Context context_;
};

}  // namespace curbstone::tensor_voting::cuda
