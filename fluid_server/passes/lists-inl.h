// Neighbour lists: groups of consecutive items of a row share the windows of cells around them; candidates are filtered
// 16 at a time by compressing in registers (compressing stores to memory are slow on some processors).
#if defined(BALLAST_LISTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BALLAST_LISTS_INL_H_
#undef BALLAST_LISTS_INL_H_
#else
#define BALLAST_LISTS_INL_H_
#endif
#include <omp.h>

#include "fluid_server/passes/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ballast::fluid {
namespace HWY_NAMESPACE {

HWY_INLINE std::uint32_t thread_index() { return static_cast<std::uint32_t>(omp_get_thread_num()); }

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
  std::uint32_t build_group(std::uint32_t begin, std::uint32_t end, Lists& lists, std::uint32_t buffer,
                            std::size_t& used) const {
    const Cells& cells = items_.cells();
    const std::uint32_t row = cells.row(items_.y[begin], items_.z[begin]);
    const int first = cell_x(begin);
    int last = first;
    std::uint32_t next = begin + 1;
    for (; next < end && next - begin < kGroup; ++next) {
      if (cells.row(items_.y[next], items_.z[next]) != row || cell_x(next) > first + static_cast<int>(Cells::kFine))
        break;
      last = cell_x(next);
    }
    Window windows[18];
    const int count = find_windows(row, first, last, windows);
    std::size_t candidates = 0;
    for (int w = 0; w < count; ++w) candidates += windows[w].end - windows[w].begin;
    auto& out = lists.buffer[buffer];
    const std::size_t needed = used + (next - begin) * (candidates + 2 * Lists::kPad);
    if (out.size() < needed) out.resize(needed + needed / 4);
    for (std::uint32_t i = begin; i < next; ++i) {
      const bool sample = items_.source[i] & Neighbourhood::kSample;
      std::uint32_t* list = out.data() + used;
      const std::uint32_t n = sample ? filter<true>(i, windows, count, list) : filter<false>(i, windows, count, list);
      lists.start[i] = static_cast<std::uint32_t>(used);
      lists.count[i] = static_cast<std::uint16_t>(std::min<std::uint32_t>(n, 65535));
      const hn::CappedTag<std::uint32_t, 16> u;
      for (std::uint32_t k = 0; k < Lists::kPad; k += static_cast<std::uint32_t>(hn::MaxLanes(u)))
        hn::StoreU(hn::Set(u, i), u, list + n + k);
      used += (n + kLanes - 1) / kLanes * kLanes;
    }
    return next;
  }

 private:
  struct Window {
    std::uint32_t begin, end;
  };

  int cell_x(std::uint32_t item) const {
    return static_cast<int>(Cells::along(items_.x[item], items_.cells().count[0]));
  }

  /// Ranges of items in the rows around `row`, between the cells first and last along x widened by the support.
  int find_windows(std::uint32_t row, int first, int last, Window* windows) const {
    const Cells& cells = items_.cells();
    const int ny = static_cast<int>(cells.count[1]), nz = static_cast<int>(cells.count[2]);
    const int cy = static_cast<int>(row) % ny, cz = static_cast<int>(row) / ny;
    const int reach_y = Dim == 2 ? 0 : 1;
    int count = 0;
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -reach_y; dy <= reach_y; ++dy) {
        int y2 = cy + dy, z2 = cz + dz;
        if (cells.periodic[1]) y2 = (y2 + ny) % ny;
        if (cells.periodic[2]) z2 = (z2 + nz) % nz;
        if (y2 < 0 || z2 < 0 || y2 >= ny || z2 >= nz) continue;
        count = add_windows(z2 * ny + y2, first - static_cast<int>(Cells::kFine), last + static_cast<int>(Cells::kFine),
                            windows, count);
      }
    return count;
  }

  int add_windows(int row, int first, int last, Window* windows, int count) const {
    if (items_.cells().periodic[0]) {
      if (last - first >= nx_ - 1) return add_window(row, 0, nx_ - 1, windows, count);
      if (first < 0) {
        count = add_window(row, first + nx_, nx_ - 1, windows, count);
        first = 0;
      } else if (last >= nx_) {
        count = add_window(row, 0, last - nx_, windows, count);
        last = nx_ - 1;
      }
    }
    return add_window(row, std::max(first, 0), std::min(last, nx_ - 1), windows, count);
  }

  int add_window(int row, int first, int last, Window* windows, int count) const {
    if (!items_.row_filled(static_cast<std::size_t>(row))) return count;
    const std::uint32_t* start =
        items_.cell_start().data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(nx_ + 1);
    const Window w{start[first], start[last + 1]};
    if (w.begin < w.end) windows[count++] = w;
    return count;
  }

  template <bool FluidOnly>
  HWY_INLINE std::uint32_t filter(std::uint32_t item, const Window* windows, int count, std::uint32_t* list) const {
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
    std::uint32_t n = 0;
    for (int w = 0; w < count; ++w) {
      const auto end = hn::Set(u, windows[w].end);
      auto index = hn::Add(hn::Iota(u, 0), hn::Set(u, windows[w].begin));
      for (std::uint32_t j = windows[w].begin; j < windows[w].end; j += lanes) {
        const auto dx = hn::Mul(hn::ConvertTo(f, hn::Sub(x, hn::BitCast(s, hn::LoadU(u, &items_.x[j])))), qx);
        const auto dz = hn::Mul(hn::ConvertTo(f, hn::Sub(z, hn::BitCast(s, hn::LoadU(u, &items_.z[j])))), qz);
        auto r2 = hn::MulAdd(dz, dz, hn::Mul(dx, dx));
        if constexpr (Dim == 3) {
          const auto dy = hn::Mul(hn::ConvertTo(f, hn::Sub(y, hn::BitCast(s, hn::LoadU(u, &items_.y[j])))), qy);
          r2 = hn::MulAdd(dy, dy, r2);
        }
        auto near = hn::And(hn::RebindMask(u, hn::Lt(r2, support2)), hn::Lt(index, end));
        if constexpr (FluidOnly) {
          const auto from = hn::LoadU(u, &items_.source[j]);
          near = hn::And(near, hn::Lt(from, hn::Set(u, Neighbourhood::kSample)));
        } else {
          near = hn::And(near, hn::Ne(index, self));
        }
        hn::StoreU(hn::Compress(index, near), u, list + n);
        n += static_cast<std::uint32_t>(hn::CountTrue(u, near));
        index = hn::Add(index, hn::Set(u, lanes));
      }
    }
    return n;
  }

  const Neighbourhood& items_;
  float support2_;
  Distances distances_;
  int nx_;
};

}  // namespace HWY_NAMESPACE
}  // namespace ballast::fluid
HWY_AFTER_NAMESPACE();
#endif
