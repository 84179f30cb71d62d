// Arrays whose size changes a little from step to step.
#pragma once
#include <cstddef>
#include <vector>

namespace ballast::fluid {

/// Resizes to `size` with room for an eighth more, not for as much again: what is kept per sample near fluid, or
/// per row of cells, is much, and their number grows a little at a time.
template <class T>
void resize_gently(std::vector<T>& out, std::size_t size) {
  if (out.capacity() < size) out.reserve(size + size / 8);
  out.resize(size);
}

}  // namespace ballast::fluid
