// Particles and the boundary samples near them in one set ("items"), sorted by cell: x fastest, cells of the support
// radius along y and z and a quarter of it along x. Neighbour lists over the items live here too; passes/ builds them.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "fluid_server/particles/coordinates.h"
#include "fluid_server/particles/particles.h"

namespace ballast::fluid {

/// Cells that tile the domain exactly.
struct Cells {
  std::array<std::uint32_t, 3> count{1, 1, 1};
  std::array<bool, 3> periodic{};
  static constexpr std::uint32_t kFine = 4;  ///< cells along x per support radius

  static std::uint32_t along(std::uint32_t x, std::uint32_t n) {
    return static_cast<std::uint32_t>((static_cast<std::uint64_t>(x) * n) >> 32);
  }
  std::uint32_t row(std::uint32_t y, std::uint32_t z) const {
    return along(z, count[2]) * count[1] + along(y, count[1]);
  }
  std::uint32_t cell(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return row(y, z) * count[0] + along(x, count[0]);
  }
  std::uint32_t rows() const { return count[1] * count[2]; }
  std::uint32_t cells() const { return rows() * count[0]; }
  std::uint32_t blocks_x() const { return (count[0] + kFine - 1) / kFine; }
};

/// Neighbour lists of all items: 32-bit item indices, padded with the item itself to a multiple of kPad (a pair of an
/// item with itself contributes nothing to any sum). Chunks of items are built by whichever thread is free.
struct Lists {
  static constexpr std::uint32_t kPad = 16, kChunk = 256;
  std::vector<std::vector<std::uint32_t>> buffer;  ///< one per chunk
  std::vector<std::uint32_t> start;                ///< per item, in its chunk's buffer
  std::vector<std::uint16_t> count;                ///< per item, without padding

  // Lists may be kept as long as no item has left its cell: the order of the items is the same then, and so is a list
  // while no pair has crossed the support.
  std::vector<float> good_until;    ///< per item, m: its list is the same until twice `moved` reaches that
  std::vector<std::uint8_t> group;  ///< at the first item of each group that shares windows: how many items it has
  std::vector<std::uint32_t> used;  ///< per chunk, entries of its buffer
  std::size_t used_at_first = 0;    ///< of all buffers, when the lists were built
  double moved = 0;                 ///< no item is farther from where it was when lists were built, m
  bool measure = false;             ///< building them finds `good_until`
  bool valid = false;               ///< they are those of this order, and `good_until` is known

  /// Before and after the lists of so many items are built anew.
  void begin(std::uint32_t items);
  void end();
  std::size_t all_used() const;

  /// What a sum over a list costs, in halves of a vector of eight.
  double cost(std::uint32_t item) const { return count[item] == 0 ? 1 : 2 + 2 * ((count[item] + 7) / 8); }

  const std::uint32_t* of(std::uint32_t item) const { return buffer[item / kChunk].data() + start[item]; }
};

/// How often searching for neighbours was skipped, and what the rest took.
struct SearchCounts {
  std::uint64_t searched = 0, kept = 0;     ///< steps
  std::uint64_t lists = 0, made_again = 0;  ///< in the steps kept: lists in all, and those whose pairs had changed
  double searched_seconds = 0, kept_seconds = 0;  ///< sorting, lists, and what is summed in the same sweep
  void add(bool was_kept, double seconds) {
    ++(was_kept ? kept : searched);
    (was_kept ? kept_seconds : searched_seconds) += seconds;
  }
};

class Neighbourhood {
 public:
  static constexpr std::uint32_t kSample = 0x80000000u;  ///< bit in `source` that marks a boundary sample

  /// `support` = H, m. Every periodic axis must be at least three supports long (checked by the scene).
  Neighbourhood(const Coordinates& coordinates, double support, int dimension, int threads);

  /// Samples that never move, and that outlive this. Sample indices in `source` are those of this span.
  void set_static_samples(std::span<const Record> samples);

  /// Sorts `before` into `after` (same size, both resized by the caller's first use) and gathers the items: all
  /// particles and every sample that can have one within the support. `moving` samples have index first_moving + k.
  /// Where nothing has left its cell since the last time, the order is that of then and only places and states are
  /// taken over; the result is the same to the last bit.
  void rebuild(const Particles& before, Particles& after, std::span<const Record> moving, std::uint32_t first_moving);

  std::uint32_t size() const { return static_cast<std::uint32_t>(record.size() - kTail); }
  const Cells& cells() const { return cells_; }
  const Coordinates& coordinates() const { return coordinates_; }
  std::size_t memory() const;  ///< bytes of all its arrays, lists included
  /// First item of each of a row's cells, and the end of the row: count[0] + 1 entries; null where it has no items.
  const std::uint32_t* cell_starts(std::size_t row) const {
    return row_filled_[row] ? start_.data() + place_of(row) * (cells_.count[0] + 1) : nullptr;
  }

  // Items, in cell order; x, y, z, record and source have kTail entries more so that vectors may read past the end.
  static constexpr std::uint32_t kTail = 64;
  std::vector<std::uint32_t> x, y, z;
  std::vector<Record> record;
  std::vector<std::uint32_t> source;                       ///< particle index, or kSample | sample index
  std::vector<std::uint32_t> fluid_item;                   ///< item of particle f
  std::vector<std::uint32_t> sample_item;                  ///< items that are samples
  std::vector<std::uint32_t> fluid_shares, sample_shares;  ///< of these, for loops over their lists (shares.h)
  Lists lists;
  SearchCounts searches;
  bool may_keep = true;  ///< false: search in every step, to compare
  /// Sets the shares, once all lists are there.
  void share_out();
  /// Lists were kept in this step but for some that were made again.
  void count_kept(std::uint64_t made_again);

 private:
  bool keep_order(const Particles& before, Particles& after, std::span<const Record> moving,
                  std::uint32_t first_moving);
  double largest_move(const Particles& before, std::span<const Record> moving) const;
  void decide_to_measure();
  std::uint32_t cell_of_moving(const Record& r) const;
  void put_static(std::uint32_t row);
  void find_rows(const Particles& before);
  void count_particles();
  void total_rows();
  void activate_rows();
  void count_moving(std::span<const Record> moving);
  void place_rows();
  void scatter(const Particles& before, Particles& after, std::span<const Record> moving, std::uint32_t first_moving);
  void put(std::uint32_t item, const Record& r, std::uint32_t from);
  static constexpr std::uint32_t kNone = ~0u;
  std::size_t place_of(std::size_t row) const { return row_place_[row]; }
  /// Where a cell stands in what is kept per cell of some rows.
  std::size_t count_at(std::uint32_t cell) const {
    const std::uint32_t nx = cells_.count[0], row = cell / nx;
    return std::size_t{row_counts_[row]} * nx + cell % nx;
  }
  std::size_t start_at(std::uint32_t cell) const {
    const std::uint32_t nx = cells_.count[0], row = cell / nx;
    return place_of(row) * (nx + 1) + cell % nx;
  }

  Coordinates coordinates_;
  Cells cells_;
  int threads_;
  // Per row. Most rows of a domain with room for splashes are empty: only those with particles, and those beside them,
  // have room for their cells. kNone: has none.
  std::vector<std::uint32_t> row_fluid_, row_all_;      // items there and, from place_rows() on, before it
  std::vector<std::uint32_t> row_counts_, row_place_;   // which of the rows with particles, of those beside too
  std::vector<std::uint8_t> row_filled_;                // has items
  std::vector<std::vector<std::uint8_t>> row_touched_;  // per sorting thread: has particles of it
  // per cell of the rows with particles
  std::vector<std::vector<std::uint32_t>> histogram_;  // per sorting thread
  std::vector<std::uint32_t> fluid_count_;
  // per cell of these and the rows beside them; the first two with an entry more a row
  std::vector<std::uint32_t> start_, start_fluid_, moving_count_;
  std::vector<std::uint32_t> static_start_;  // per cell
  // per block (row, kFine cells)
  std::vector<std::uint8_t> occupied_, active_;
  std::vector<std::uint32_t> cell_of_;                    // of particles before
  std::vector<std::uint32_t> moving_cell_, moving_item_;  // of moving samples; kNone: inactive
  std::span<const Record> fixed_;
  std::vector<std::uint32_t> static_source_;  // in the order of their cells
  // searches until lists are measured again, and how many those are after lists that could not be kept
  std::uint32_t wait_ = 0, pause_ = 0;
  bool was_kept_ = false;  // the lists at hand have been kept once
};

}  // namespace ballast::fluid
