// Room for what is kept of the pairs for the products of one solve.
#include <algorithm>
#include <numeric>
#include <utility>

#include "fluid_server/passes/passes.h"

namespace ballast::fluid {

namespace {

/// Sums of count(i) over all items before each: `before`. Returns the sum over all.
template <class Count>
std::uint32_t sum_before(std::uint32_t size, int threads, Count&& count, std::vector<std::uint32_t>& before) {
  const std::uint32_t chunks = (size + Lists::kChunk - 1) / Lists::kChunk;
  const auto end = [&](std::uint32_t c) { return std::min(size, (c + 1) * Lists::kChunk); };
  std::vector<std::uint32_t> chunk(chunks + 1, 0);  // before each chunk
  resize_gently(before, size);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (std::uint32_t c = 0; c < chunks; ++c)
    for (std::uint32_t i = c * Lists::kChunk; i < end(c); ++i)
      before[i] = std::exchange(chunk[c + 1], chunk[c + 1] + count(i));
  std::partial_sum(chunk.begin(), chunk.end(), chunk.begin());
#pragma omp parallel for num_threads(threads) schedule(static)
  for (std::uint32_t c = 0; c < chunks; ++c)
    for (std::uint32_t i = c * Lists::kChunk; i < end(c); ++i) before[i] += chunk[c];
  return chunk.back();
}

/// At least `size`, with room for a sixteenth more: it grows a little at a time. Old and new never exist at once.
void replace_if_smaller(std::vector<float>& out, std::size_t size) {
  if (out.size() >= size) return;
  out = std::vector<float>();
  out = std::vector<float>(size + size / 16);
}

}  // namespace

void KeptPairs::make_room_for_slopes(const Neighbourhood& items, std::uint32_t in_vector, int threads) {
  lanes = in_vector;
  const auto vectors = [&](std::uint32_t i) { return (items.lists.count[i] + lanes - 1) / lanes; };
  replace_if_smaller(slope, std::size_t{sum_before(items.size(), threads, vectors, slopes_before)} * lanes);
}

void KeptPairs::make_room_for_values(const Neighbourhood& items, int threads) {
  const auto vectors = [&](std::uint32_t i) {
    const std::uint32_t source = items.source[i];
    const bool with_samples = source & Neighbourhood::kSample || sum[source].touches_samples != 0;
    return with_samples ? (items.lists.count[i] + lanes - 1) / lanes : 0;
  };
  replace_if_smaller(value, std::size_t{sum_before(items.size(), threads, vectors, values_before)} * lanes);
}

std::size_t KeptPairs::memory() const {
  return (slope.capacity() + value.capacity()) * sizeof(float) + sum.capacity() * sizeof(Sum) +
         point.capacity() * sizeof(Point) + active.capacity() * sizeof(Active) +
         (slopes_before.capacity() + values_before.capacity()) * sizeof(std::uint32_t);
}

}  // namespace ballast::fluid
