#include "common/packing/value_packer.hpp"

#include <zstd.h>

#include <memory>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace curbstone {
namespace {

constexpr int kLevel = 1;  // the fastest: packed values may be needed again soon

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

/// zstd's context takes half a megabyte. It is kept for the next caller, because a thread that packs may live for one
/// task only.
template <class Context>
class ContextPool {
 public:
  /// Exclusive use of a context for the lifetime of this object.
  class Loan {
   public:
    Loan(ContextPool& pool, Context* (*make)()) : pool_(pool) {
      {
        const std::lock_guard lock(pool_.mutex_);
        if (!pool_.idle_.empty()) {
          context_ = std::move(pool_.idle_.back());
          pool_.idle_.pop_back();
        }
      }
      if (!context_) context_.reset(make());
      if (!context_) throw std::bad_alloc();
    }
    ~Loan() {
      const std::lock_guard lock(pool_.mutex_);
      pool_.idle_.push_back(std::move(context_));
    }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    [[nodiscard]] Context* get() const { return context_.get(); }

   private:
    ContextPool& pool_;
    std::unique_ptr<Context, FreeContext> context_;
  };

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Context, FreeContext>> idle_;
};

}  // namespace

void ValuePacker::put_planes(const std::byte* values, std::size_t count, std::size_t size) {
  const std::size_t begin = bytes_.size();
  bytes_.resize(begin + count * size);
  for (std::size_t plane = 0; plane < size; ++plane) {
    std::byte* const to = bytes_.data() + begin + plane * count;
    for (std::size_t i = 0; i < count; ++i) to[i] = values[i * size + plane];
  }
}

PackedValues ValuePacker::pack() const {
  static ContextPool<ZSTD_CCtx> pool;
  const ContextPool<ZSTD_CCtx>::Loan context(pool, ZSTD_createCCtx);
  std::vector<std::byte> room(ZSTD_compressBound(bytes_.size()));
  const std::size_t size =
      ZSTD_compressCCtx(context.get(), room.data(), room.size(), bytes_.data(), bytes_.size(), kLevel);
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // the only possible error: the buffer is large enough
  return {room.begin(), room.begin() + static_cast<std::ptrdiff_t>(size)};
}

ValueUnpacker::ValueUnpacker(std::span<const std::byte> packed) {
  static ContextPool<ZSTD_DCtx> pool;
  const ContextPool<ZSTD_DCtx>::Loan context(pool, ZSTD_createDCtx);
  const unsigned long long size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN)
    throw std::runtime_error("these are no packed values");
  bytes_.resize(size);
  const std::size_t got =
      ZSTD_decompressDCtx(context.get(), bytes_.data(), bytes_.size(), packed.data(), packed.size());
  if (ZSTD_isError(got) != 0) throw std::runtime_error(std::string("packed values: ") + ZSTD_getErrorName(got));
}

std::size_t ValueUnpacker::take_count(std::size_t size) {
  const auto count = take<std::uint64_t>();
  if (count > (bytes_.size() - at_) / size) throw std::runtime_error("packed values: more is asked for than there is");
  return count;
}

void ValueUnpacker::take_planes(std::byte* values, std::size_t count, std::size_t size) {
  if (count * size > bytes_.size() - at_) throw std::runtime_error("packed values: more is asked for than there is");
  for (std::size_t plane = 0; plane < size; ++plane) {
    const std::byte* const from = bytes_.data() + at_ + plane * count;
    for (std::size_t i = 0; i < count; ++i) values[i * size + plane] = from[i];
  }
  at_ += count * size;
}

}  // namespace curbstone
