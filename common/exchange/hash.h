// 64-bit FNV-1a over bit patterns: equal states have equal hashes, on every process.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/exchange/records.h"

namespace ballast::exchange {

class Hash {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* p = static_cast<const unsigned char*>(data);
    for (std::size_t k = 0; k < bytes; ++k) value_ = (value_ ^ p[k]) * 0x100000001b3ULL;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

/// Of position, orientation, velocity and angular velocity of all bodies, in order.
inline std::uint64_t state_hash(std::span<const BodyState> states) {
  Hash hash;
  for (const BodyState& s : states) hash.add(s.position, sizeof(double) * 13);
  return hash.value();
}

}  // namespace ballast::exchange
