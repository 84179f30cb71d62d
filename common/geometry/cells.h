// Cells along one axis (or radius) of a solid or container; products of such rows are its layers of samples.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/geometry/form.h"

namespace ballast::geometry {

/// One cell; `room` and `outer` are the depths of its nearest face below the surface of the room and below the outer
/// surface, along this axis, m. room: -1 beside the room, infinite where there is none.
struct Cell {
  double centre = 0, width = 0, room = kInf, outer = 0;
};

inline int cell_count(double length, double spacing) {
  return std::max(1, static_cast<int>(std::lround(length / spacing)));
}

/// The whole length, without a room: n = round(length / spacing) equal cells.
inline std::vector<Cell> solid_cells(double lo, double hi, double spacing) {
  const int n = cell_count(hi - lo, spacing);
  const double pitch = (hi - lo) / n;
  std::vector<Cell> cells;
  for (int i = 0; i < n; ++i) cells.push_back({lo + (i + 0.5) * pitch, pitch, kInf, std::min(i, n - 1 - i) * pitch});
  return cells;
}

/// Thicknesses of the layers of a wall, from the room outwards: the room's pitch goes on, the last is clipped; a
/// remainder below half a pitch joins the last layer, because a sliver would sit closer than its neighbours resolve.
inline std::vector<double> wall_layers(double wall, double pitch) {
  std::vector<double> layers;
  double left = wall;
  while (left >= 1.5 * pitch) {
    layers.push_back(pitch);
    left -= pitch;
  }
  layers.push_back(left);
  return layers;
}

/// Room from lo to hi with walls on the sides asked for.
inline std::vector<Cell> room_cells(double lo, double hi, double spacing, double wall, bool wall_lo, bool wall_hi) {
  const int n = cell_count(hi - lo, spacing);
  const double pitch = (hi - lo) / n;
  const double outer_lo = wall_lo ? lo - wall : lo, outer_hi = wall_hi ? hi + wall : hi;
  std::vector<Cell> cells;
  const auto add = [&](double from, double to, double room) {
    cells.push_back({0.5 * (from + to), to - from, room, std::min(from - outer_lo, outer_hi - to)});
  };
  const std::vector<double> layers = wall_layers(wall, pitch);
  if (wall_lo) {
    double at = outer_lo;
    for (auto it = layers.rbegin(); it != layers.rend(); ++it) {
      add(at, at + *it, lo - (at + *it));
      at += *it;
    }
  }
  for (int i = 0; i < n; ++i) add(lo + i * pitch, lo + (i + 1) * pitch, -1);
  if (wall_hi) {
    double at = hi;
    for (const double layer : layers) {
      add(at, at + layer, at - hi);
      at += layer;
    }
  }
  return cells;
}

/// The single cell of 1 m along y in dimension 2.
inline std::vector<Cell> depth_cell(bool room) { return {{0, 1, room ? -1 : kInf, kInf}}; }

/// Whether a product of cells is solid and begins less than `depth` below a surface (whole layers are kept).
inline bool keep_cell(double room, double outer, double depth) {
  const double limit = depth * (1 - 1e-9);
  return room > -0.5 && (room < limit || outer < limit);
}

}  // namespace ballast::geometry
