// One-writer one-reader byte ring in shared memory: the copying and the counters; waiting is the caller's.
#pragma once
#include <cstddef>
#include <cstring>
#include <span>

#include "common/exchange/layout.h"

namespace ballast::exchange {

class Ring {
 public:
  Ring() = default;
  /// `bytes` has a power-of-two size of at most 2^31.
  Ring(RingCounters& counters, std::span<std::byte> bytes) : counters_(&counters), bytes_(bytes) {}

  std::uint32_t capacity() const { return static_cast<std::uint32_t>(bytes_.size()); }
  const Word& tail() const { return counters_->tail; }

  /// Writer: bytes in use; more than capacity() means that the reader has corrupted its counter.
  std::uint32_t used_by_writer(std::uint32_t tail_seen) const {
    return counters_->head.load(std::memory_order_relaxed) - tail_seen;  // relaxed: our own counter
  }
  /// Writer. acquire: partner is release_to_writer(); the bytes that we overwrite next have been read.
  std::uint32_t load_tail() const { return counters_->tail.load(std::memory_order_acquire); }
  /// Writer: copies behind head + at, without publishing.
  void put(std::uint32_t at, const void* from, std::size_t count) {
    const std::size_t start = (counters_->head.load(std::memory_order_relaxed) + at) & mask();
    const std::size_t first = std::min(count, bytes_.size() - start);
    if (first != 0) std::memcpy(bytes_.data() + start, from, first);
    if (count > first) std::memcpy(bytes_.data(), static_cast<const std::byte*>(from) + first, count - first);
  }
  /// Writer. release: partner is load_head(); the bytes put before are visible to whoever sees this head.
  void publish(std::uint32_t count) {
    counters_->head.store(counters_->head.load(std::memory_order_relaxed) + count, std::memory_order_release);
  }

  /// Reader: bytes to read. acquire: partner is publish().
  std::uint32_t readable() const {
    return counters_->head.load(std::memory_order_acquire) - counters_->tail.load(std::memory_order_relaxed);
  }
  /// Reader: copies from tail + at, without giving back.
  void get(std::uint32_t at, void* to, std::size_t count) const {
    const std::size_t start = (counters_->tail.load(std::memory_order_relaxed) + at) & mask();
    const std::size_t first = std::min(count, bytes_.size() - start);
    if (first != 0) std::memcpy(to, bytes_.data() + start, first);
    if (count > first) std::memcpy(static_cast<std::byte*>(to) + first, bytes_.data(), count - first);
  }
  /// Reader. release: partner is load_tail(). seq_cst besides, since tail is a futex word: the caller then wakes.
  void release_to_writer(std::uint32_t count) {
    counters_->tail.store(counters_->tail.load(std::memory_order_relaxed) + count, std::memory_order_seq_cst);
  }

 private:
  std::size_t mask() const { return bytes_.size() - 1; }
  RingCounters* counters_ = nullptr;
  std::span<std::byte> bytes_;
};

}  // namespace ballast::exchange
