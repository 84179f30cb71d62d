// Room for the neighbour lists, and the shares of the loops over them.
#include <numeric>

#include "fluid_server/neighbours/neighbourhood.h"
#include "fluid_server/neighbours/resize.h"
#include "fluid_server/neighbours/shares.h"

namespace ballast::fluid {

void Lists::begin(std::uint32_t items) {
  resize_gently(start, items);
  resize_gently(count, items);
  if (measure) resize_gently(good_until, items), resize_gently(group, items);
  used.assign((items + kChunk - 1) / kChunk, 0);
  buffer.resize(used.size());
  moved = 0;
}

void Lists::end() {
  constexpr std::size_t kSpare = 512;                          // the next list may turn out long
  for (std::size_t chunk = 0; chunk < used.size(); ++chunk) {  // where more or other items were before
    auto& lists = buffer[chunk];
    if (lists.size() <= used[chunk] + used[chunk] / 4 + kSpare) continue;
    lists.resize(used[chunk] + used[chunk] / 16 + kSpare);
    lists.shrink_to_fit();
  }
  used_at_first = all_used();
  valid = measure;
}

std::size_t Lists::all_used() const { return std::accumulate(used.begin(), used.end(), std::size_t{0}); }

void Neighbourhood::share_out() {
  const auto shares = [this](const std::vector<std::uint32_t>& of) {
    return shares_of(static_cast<std::uint32_t>(of.size()), threads_,
                     [&](std::uint32_t k) { return lists.cost(of[k]); });
  };
  fluid_shares = shares(fluid_item);
  sample_shares = shares(sample_item);
}

}  // namespace ballast::fluid
