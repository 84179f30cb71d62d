// What waits to be sent to monitors: a queue of bounded size that refuses what does not fit, and never waits.
#pragma once
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace ballast::launch {

template <class Item>
class PublishQueue {
 public:
  explicit PublishQueue(std::size_t capacity) : capacity_(capacity) {}

  /// Any thread but the taker's. False, and counted: no room for `bytes` more, or closed.
  bool offer(Item item, std::size_t bytes) {
    {
      const std::lock_guard lock(mutex_);
      if (closed_ || used_ + bytes > capacity_) {
        ++dropped_;
        return false;
      }
      used_ += bytes;
      items_.emplace_back(std::move(item), bytes);
    }
    changed_.notify_all();
    return true;
  }
  /// Last item, for which there is always room; nothing is taken in afterwards.
  void close(Item last) {
    {
      const std::lock_guard lock(mutex_);
      items_.emplace_back(std::move(last), 0);
      closed_ = true;
    }
    changed_.notify_all();
  }
  /// The taker: waits for the next item; nothing once the queue is closed and empty.
  std::optional<Item> take() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !items_.empty(); });
    if (items_.empty()) return std::nullopt;
    auto [item, bytes] = std::move(items_.front());
    items_.pop_front();
    used_ -= bytes;
    return std::move(item);
  }
  /// The taker has sent everything and will not touch anything again.
  void mark_done() {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    changed_.notify_all();
  }
  /// Waits for that; false if it has not come in time: what is left then counts as dropped.
  bool wait_done(std::chrono::milliseconds at_most) {
    std::unique_lock lock(mutex_);
    if (changed_.wait_for(lock, at_most, [this] { return done_; })) return true;
    dropped_ += items_.size();
    items_.clear();
    return false;
  }
  std::uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  const std::size_t capacity_;  // bytes
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::pair<Item, std::size_t>> items_;
  std::size_t used_ = 0;
  std::uint64_t dropped_ = 0;
  bool closed_ = false, done_ = false;
};

}  // namespace ballast::launch
