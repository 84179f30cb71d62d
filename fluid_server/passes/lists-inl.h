// Neighbour lists: groups of consecutive items of a row share the windows of cells around them; candidates are filtered
// 16 at a time by compressing in registers (compressing stores to memory are slow on some processors).
#if defined(BALLAST_LISTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BALLAST_LISTS_INL_H_
#undef BALLAST_LISTS_INL_H_
#else
#define BALLAST_LISTS_INL_H_
#endif
#include <algorithm>
#include <cmath>
#include <numeric>

#include "fluid_server/passes/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ballast::fluid {
namespace HWY_NAMESPACE {

template <int Dim>
class ListBuilder {
  using FW = hn::CappedTag<float, 16>;
  using IW = hn::RebindToSigned<FW>;
  using UW = hn::RebindToUnsigned<FW>;
  static constexpr std::uint32_t kGroup = 8;

 public:
  ListBuilder(const Neighbourhood& items, const Kernel& kernel)
      : items_(items),
        support2_(static_cast<float>(kernel.support * kernel.support)),
        distances_(items.coordinates()),
        nx_(static_cast<int>(items.cells().count[0])) {}

  /// Lists of items begin .. result (in the same row and near each other along x).
  std::uint32_t build_group(std::uint32_t begin, std::uint32_t end, Lists& lists, std::uint32_t chunk) const {
    const std::uint32_t row = row_of(begin);
    const int first = cell_x(begin);
    std::uint32_t next = begin + 1;
    for (; next < end && next - begin < kGroup; ++next)
      if (row_of(next) != row || cell_x(next) > first + static_cast<int>(Cells::kFine)) break;
    const Windows windows = find_windows(row, first, cell_x(next - 1));
    std::uint32_t used = lists.used[chunk];
    for (std::uint32_t i = begin; i < next; ++i) used = add_list(i, windows, lists, chunk, used);
    lists.used[chunk] = used;
    if (lists.measure) lists.group[begin] = static_cast<std::uint8_t>(next - begin);
    return next;
  }

  /// The same where lists are kept: only those whose pairs may have changed are made again, behind the others of their
  /// chunk if they have become too long for their place. Adds to their number.
  std::uint32_t mend_group(std::uint32_t begin, Lists& lists, std::uint32_t chunk, std::uint64_t& made_again) const {
    const std::uint32_t next = begin + lists.group[begin];
    const float moved = static_cast<float>(2 * lists.moved);
    const auto outdated = [&](std::uint32_t i) { return lists.good_until[i] <= moved; };
    std::uint32_t i = begin;
    while (i < next && !outdated(i)) ++i;
    if (i == next) return next;
    const Windows windows = find_windows(row_of(begin), cell_x(begin), cell_x(next - 1));
    std::uint32_t used = lists.used[chunk];
    for (; i < next; ++i) {
      if (!outdated(i)) continue;
      ++made_again;
      const std::uint32_t place = lists.start[i], room = padded(lists.count[i]);
      const std::uint32_t end = add_list(i, windows, lists, chunk, used);
      if (padded(lists.count[i]) > room) {
        used = end;
        continue;
      }
      std::uint32_t* const all = lists.buffer[chunk].data();
      std::copy_n(all + used, padded(lists.count[i]), all + place);
      lists.start[i] = place;
    }
    lists.used[chunk] = used;
    return next;
  }

 private:
  struct Window {
    std::uint32_t begin, end;
  };

  struct Windows {
    Window of[18];
    int count = 0;
  };

  static std::uint32_t padded(std::uint32_t n) { return (n + kLanes - 1) / kLanes * kLanes; }

  std::uint32_t row_of(std::uint32_t item) const { return items_.cells().row(items_.y[item], items_.z[item]); }

  int cell_x(std::uint32_t item) const {
    return static_cast<int>(Cells::along(items_.x[item], items_.cells().count[0]));
  }

  /// Room for one more list, of all that the windows show.
  static void make_room(std::vector<std::uint32_t>& out, std::uint32_t used, const Windows& windows) {
    std::size_t needed = used + 2 * Lists::kPad;
    for (int w = 0; w < windows.count; ++w) needed += windows.of[w].end - windows.of[w].begin;
    if (out.size() >= needed) return;
    out.reserve(needed + needed / 8);  // not twice as much, as resize alone may
    out.resize(out.capacity());
  }

  /// The list of an item, padded, at `used` in its chunk's buffer. Returns where it ends.
  std::uint32_t add_list(std::uint32_t i, const Windows& windows, Lists& lists, std::uint32_t chunk,
                         std::uint32_t used) const {
    make_room(lists.buffer[chunk], used, windows);
    std::uint32_t* const list = lists.buffer[chunk].data() + used;
    const bool sample = items_.source[i] & Neighbourhood::kSample;
    float room = 0;
    std::uint32_t n;
    if (lists.measure) {
      n = sample ? filter<true, true>(i, windows, list, room) : filter<false, true>(i, windows, list, room);
      lists.good_until[i] = room + static_cast<float>(2 * lists.moved);
    } else {
      n = sample ? filter<true, false>(i, windows, list, room) : filter<false, false>(i, windows, list, room);
    }
    lists.start[i] = used;
    lists.count[i] = static_cast<std::uint16_t>(std::min<std::uint32_t>(n, 65535));
    const hn::CappedTag<std::uint32_t, 16> u;
    for (std::uint32_t k = 0; k < Lists::kPad; k += static_cast<std::uint32_t>(hn::MaxLanes(u)))
      hn::StoreU(hn::Set(u, i), u, list + n + k);
    return used + padded(n);
  }

  /// Ranges of items in the rows around `row`, between the cells first and last along x widened by the support.
  Windows find_windows(std::uint32_t row, int first, int last) const {
    Windows windows;
    const Cells& cells = items_.cells();
    const int ny = static_cast<int>(cells.count[1]), nz = static_cast<int>(cells.count[2]);
    const int cy = static_cast<int>(row) % ny, cz = static_cast<int>(row) / ny;
    const int reach_y = Dim == 2 ? 0 : 1;
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -reach_y; dy <= reach_y; ++dy) {
        int y2 = cy + dy, z2 = cz + dz;
        if (cells.periodic[1]) y2 = (y2 + ny) % ny;
        if (cells.periodic[2]) z2 = (z2 + nz) % nz;
        if (y2 < 0 || z2 < 0 || y2 >= ny || z2 >= nz) continue;
        add_windows(z2 * ny + y2, first - static_cast<int>(Cells::kFine), last + static_cast<int>(Cells::kFine),
                    windows);
      }
    return windows;
  }

  void add_windows(int row, int first, int last, Windows& windows) const {
    if (items_.cells().periodic[0]) {
      if (last - first >= nx_ - 1) return add_window(row, 0, nx_ - 1, windows);
      if (first < 0) {
        add_window(row, first + nx_, nx_ - 1, windows);
        first = 0;
      } else if (last >= nx_) {
        add_window(row, 0, last - nx_, windows);
        last = nx_ - 1;
      }
    }
    add_window(row, std::max(first, 0), std::min(last, nx_ - 1), windows);
  }

  void add_window(int row, int first, int last, Windows& windows) const {
    const std::uint32_t* start = items_.cell_starts(static_cast<std::size_t>(row));
    if (!start) return;
    const Window w{start[first], start[last + 1]};
    if (w.begin < w.end) windows.of[windows.count++] = w;
  }

  /// The list, and with Measure in `room` how much nearer or farther (m) any two items may come before it changes.
  template <bool FluidOnly, bool Measure>
  HWY_INLINE std::uint32_t filter(std::uint32_t item, const Windows& windows, std::uint32_t* list, float& room) const {
    const FW f;
    const IW s;
    const UW u;
    const std::uint32_t lanes = static_cast<std::uint32_t>(hn::MaxLanes(f));
    const auto x = hn::Set(s, static_cast<std::int32_t>(items_.x[item]));
    const auto y = hn::Set(s, static_cast<std::int32_t>(items_.y[item]));
    const auto z = hn::Set(s, static_cast<std::int32_t>(items_.z[item]));
    const auto qx = hn::Set(f, distances_.qx), qy = hn::Set(f, distances_.qy), qz = hn::Set(f, distances_.qz);
    const auto support2 = hn::Set(f, support2_);
    const auto self = hn::Set(u, item);
    auto gap = support2;  // smallest difference of a squared distance to the squared support
    std::uint32_t n = 0;
    for (int w = 0; w < windows.count; ++w) {
      const Window& window = windows.of[w];
      const auto end = hn::Set(u, window.end);
      auto index = hn::Add(hn::Iota(u, 0), hn::Set(u, window.begin));
      for (std::uint32_t j = window.begin; j < window.end; j += lanes) {
        const auto dx = hn::Mul(hn::ConvertTo(f, hn::Sub(x, hn::BitCast(s, hn::LoadU(u, &items_.x[j])))), qx);
        const auto dz = hn::Mul(hn::ConvertTo(f, hn::Sub(z, hn::BitCast(s, hn::LoadU(u, &items_.z[j])))), qz);
        auto r2 = hn::MulAdd(dz, dz, hn::Mul(dx, dx));
        if constexpr (Dim == 3) {
          const auto dy = hn::Mul(hn::ConvertTo(f, hn::Sub(y, hn::BitCast(s, hn::LoadU(u, &items_.y[j])))), qy);
          r2 = hn::MulAdd(dy, dy, r2);
        }
        auto candidate = hn::Lt(index, end);
        if constexpr (FluidOnly) {
          const auto from = hn::LoadU(u, &items_.source[j]);
          candidate = hn::And(candidate, hn::Lt(from, hn::Set(u, Neighbourhood::kSample)));
        } else {
          candidate = hn::And(candidate, hn::Ne(index, self));
        }
        const auto near = hn::And(hn::RebindMask(u, hn::Lt(r2, support2)), candidate);
        if constexpr (Measure)
          gap = hn::IfThenElse(hn::RebindMask(f, candidate), hn::Min(gap, hn::Abs(hn::Sub(r2, support2))), gap);
        hn::StoreU(hn::Compress(index, near), u, list + n);
        n += static_cast<std::uint32_t>(hn::CountTrue(u, near));
        index = hn::Add(index, hn::Set(u, lanes));
      }
    }
    if constexpr (Measure) {
      // |r - H| = |r^2 - H^2| / (r + H) with r up to 1.1 H; what the rounding of r^2 may hide is taken off.
      const float support = std::sqrt(support2_);
      const float found = hn::GetLane(hn::MinOfLanes(f, gap)) / (2.1f * support);
      room = std::min(found, 0.1f * support) - 2e-6f * support;
    }
    return n;
  }

  const Neighbourhood& items_;
  float support2_;
  Distances distances_;
  int nx_;
};

/// Calls group(chunk, first item, end of the chunk) for the groups of all chunks, which does what there is to do and
/// returns the item behind it, and `then` with the items of each.
template <class Group, class Then>
void for_each_group(std::uint32_t size, int threads, Group&& group, Then&& then) {
  const std::uint32_t chunks = (size + Lists::kChunk - 1) / Lists::kChunk;
  for_each_by_turns(chunks, threads, [&](std::size_t at) {
    const std::uint32_t chunk = static_cast<std::uint32_t>(at);
    const std::uint32_t end = std::min(size, (chunk + 1) * Lists::kChunk);
    for (std::uint32_t begin = chunk * Lists::kChunk; begin < end;) {
      const std::uint32_t next = group(chunk, begin, end);
      then(begin, next);
      begin = next;
    }
  });
}

/// All lists anew; `then` is called with the items of each group whose lists are done.
template <int Dim, class Then>
void SearchAll(Neighbourhood& items, const ListBuilder<Dim>& builder, int threads, Then&& then) {
  Lists& lists = items.lists;
  lists.begin(items.size());
  for_each_group(
      items.size(), threads,
      [&](std::uint32_t chunk, std::uint32_t begin, std::uint32_t end) {
        return builder.build_group(begin, end, lists, chunk);
      },
      then);
  lists.end();
}

/// The same where lists are kept: how many were made again.
template <int Dim, class Then>
std::uint64_t MendAll(Neighbourhood& items, const ListBuilder<Dim>& builder, int threads, Then&& then) {
  Lists& lists = items.lists;
  std::vector<std::uint64_t> made_again(lists.buffer.size(), 0);
  for_each_group(
      items.size(), threads,
      [&](std::uint32_t chunk, std::uint32_t begin, std::uint32_t) {
        return builder.mend_group(begin, lists, chunk, made_again[chunk]);
      },
      then);
  return std::accumulate(made_again.begin(), made_again.end(), std::uint64_t{0});
}

}  // namespace HWY_NAMESPACE
}  // namespace ballast::fluid
HWY_AFTER_NAMESPACE();
#endif
