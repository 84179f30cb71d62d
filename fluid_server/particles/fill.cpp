// Filling fluids on a lattice.
#include "fluid_server/particles/fill.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <unordered_map>

namespace ballast::fluid {

namespace {

/// Where a fluid may be before bodies are carved out.
struct Region {
  Box3 bounds;                                  // lattice is laid from bounds.min with whole cells to bounds.max
  std::function<double(const Vec3&)> distance;  // signed, negative inside, m
  double top;
};

double box_distance(const Box3& box, const Vec3& p, int dimension) {
  Vec3 q = (p - 0.5 * (box.min + box.max)).cwiseAbs() - 0.5 * (box.max - box.min);
  if (dimension == 2) q[1] = -1e300;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

Error fill_error(const Fluid& fluid, std::string what, std::string cure) {
  return {std::move(what), std::move(cure), "fluids." + fluid.name};  // the coordinator knows its line in the scene
}

Result<Region> level_region(const Scene& scene, const std::vector<Body>& bodies, const Fluid& fluid) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (scene.models[b].name != fluid.fill.container) continue;
    const Solid* solid = &bodies[b].solid;
    if (!solid->is_container()) break;
    const Pose pose = bodies[b].pose;
    const double level = fluid.fill.level;
    // Room of the container: bounds of the solid less its walls is not needed exactly, sites outside are refused.
    Box3 local = solid->bounds();
    if (scene.models[b].shape.kind == ShapeKind::kOpenBox)
      local = {Vec3::Zero(), scene.models[b].shape.size};
    else if (scene.models[b].shape.hollow) {
      const Shape& shape = scene.models[b].shape;
      Vec3 half = Vec3::Constant(shape.radius);
      if (shape.kind == ShapeKind::kCylinder) half[scene.world.dimension == 2 ? 1 : 2] = shape.length / 2;
      local = {-half, half};
    }
    Box3 bounds{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p = pose.position + pose.rotation * Vec3((corner & 1 ? local.max : local.min)[0],
                                                          (corner & 2 ? local.max : local.min)[1],
                                                          (corner & 4 ? local.max : local.min)[2]);
      bounds.min = bounds.min.cwiseMin(p);
      bounds.max = bounds.max.cwiseMax(p);
    }
    bounds.max[2] = std::min(bounds.max[2], level);
    auto distance = [solid, pose, level](const Vec3& p) {
      return std::max(solid->room_distance(pose.rotation.conjugate() * (p - pose.position)), p[2] - level);
    };
    return Region{bounds, distance, bounds.max[2]};
  }
  return fill_error(fluid,
                    fmt::format("fluid '{}' fills '{}', which is not a container", fluid.name, fluid.fill.container),
                    "name a model whose shape is open_box, hollow_sphere or hollow_cylinder");
}

Result<Region> region_of(const Scene& scene, const std::vector<Body>& bodies, const Fluid& fluid,
                         std::optional<Solid>& mesh) {
  const int dimension = scene.world.dimension;
  if (fluid.fill.kind == FillKind::kLevel) return level_region(scene, bodies, fluid);
  if (fluid.fill.kind == FillKind::kBox) {
    const Box3 box = fluid.fill.box;
    return Region{box, [box, dimension](const Vec3& p) { return box_distance(box, p, dimension); }, box.max[2]};
  }
  Shape shape;
  shape.kind = ShapeKind::kMesh;
  shape.mesh = fluid.fill.mesh;
  shape.scale = fluid.fill.scale;
  auto solid = Solid::make(shape, dimension, scene.world.spacing, false);
  if (!solid) return fill_error(fluid, solid.error().what, solid.error().cure);
  mesh.emplace(*std::move(solid));
  const Pose pose = fluid.fill.pose;
  const Solid* form = &*mesh;
  const Box3 local = form->bounds();
  const Vec3 centre = pose.position + pose.rotation * (0.5 * (local.min + local.max));
  const double reach = 0.5 * (local.max - local.min).norm();
  Region region{{centre.array() - reach, centre.array() + reach},
                [form, pose](const Vec3& p) { return form->distance(pose.rotation.conjugate() * (p - pose.position)); },
                centre[2] + reach};
  return region;
}

/// One lattice site that may hold a particle.
/// Signed clearance from solids: positive outside all of them.
class Obstacles {
 public:
  Obstacles(const Scene& scene, const std::vector<Body>& bodies, double reach) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      Box3 bounds = bodies[b].solid.bounds();
      const double radius = std::max(bounds.min.norm(), bounds.max.norm());
      const bool everywhere = !std::isfinite(radius) || bodies[b].solid.is_container();
      one_.push_back({&bodies[b], everywhere ? 1e300 : radius + reach});
    }
    (void)scene;
  }
  double clearance(const Vec3& p) const {
    double nearest = 1e300;
    for (const One& one : one_) {
      const Vec3 local = p - one.body->pose.position;
      if (one.radius < 1e299 && local.squaredNorm() > one.radius * one.radius) continue;
      nearest = std::min(nearest, one.body->solid.distance(one.body->pose.rotation.conjugate() * local));
    }
    return nearest;
  }

 private:
  struct One {
    const Body* body;
    double radius;
  };
  std::vector<One> one_;
};

/// Share of a lattice cell where `outside` is negative, and the centre of that part, from distances at the centres of 4
/// sub-cells per axis; exact for faces along axes.
struct Part {
  double share = 0;
  Vec3 centre = Vec3::Zero();
};
Part part_of_cell(const std::function<double(const Vec3&)>& outside, const Vec3& centre, const Vec3& pitch,
                  int dimension) {
  constexpr int n = 4;
  Part part;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < (dimension == 2 ? 1 : n); ++b)
      for (int c = 0; c < n; ++c) {
        const Vec3 offset((a + 0.5) / n - 0.5, dimension == 2 ? 0.0 : (b + 0.5) / n - 0.5, (c + 0.5) / n - 0.5);
        const Vec3 p = centre + offset.cwiseProduct(pitch);
        const double width = (dimension == 2 ? std::sqrt(pitch[0] * pitch[2]) : std::cbrt(pitch.prod())) / n;
        const double inside = std::clamp(0.5 - outside(p) / width, 0.0, 1.0);
        part.share += inside;
        part.centre += inside * p;
      }
  if (part.share > 0) part.centre /= part.share;
  part.share /= dimension == 2 ? n * n : n * n * n;
  return part;
}

/// A lattice cell that a surface cuts.
struct CutCell {
  std::array<int, 3> at;
  Part part;
};

/// Stands for the air above a free surface while the start is relaxed.
struct Ghost {
  Vec3 position;
  double volume;
};

struct FilledOne {
  std::vector<Vec3> sites;
  std::vector<Ghost> ghosts;
  double volume = 0;  // of all particles, m^3
  double asked = 0;
};

/// Particles for the cells that surfaces cut: each gets one or none, as its share of fluid is above or below a
/// threshold that runs through the cells as a low-discrepancy sequence (Kronecker's with powers of the root of g^4 = g
/// + 1). Along every line and in every plane of cells the thresholds are spread evenly, so that the volume is right to
/// about a particle around every piece of surface, and no side is favoured: a channel with a few particles too many
/// pushes its walls apart.
void place_cut(const std::vector<CutCell>& cells, std::vector<Vec3>& sites) {
  constexpr double kGenerator = 1.2207440846057596;
  constexpr int kStarts = 64;  // of the sequence; the one that hits the whole volume best is taken
  double whole = 0;
  for (const CutCell& cell : cells) whole += cell.part.share;
  const auto has_particle = [&](const CutCell& cell, int start) {
    double t = (start + 0.5) / kStarts, alpha = 1;
    for (int k = 0; k < 3; ++k) t += cell.at[static_cast<std::size_t>(k)] * (alpha /= kGenerator);
    return t - std::floor(t) < cell.part.share;
  };
  int best = 0;
  double least = 1e300;
  for (int start = 0; start < kStarts; ++start) {
    const auto placed = std::ranges::count_if(cells, [&](const CutCell& cell) { return has_particle(cell, start); });
    if (const double off = std::abs(static_cast<double>(placed) - whole); off < least) best = start, least = off;
  }
  for (const CutCell& cell : cells)
    if (has_particle(cell, best)) sites.push_back(cell.part.centre);
}

FilledOne fill_one(const Region& region, const Obstacles& obstacles, const Scene& scene, double support) {
  const int dimension = scene.world.dimension;
  const double d = scene.world.spacing;
  std::array<int, 3> n{1, 1, 1};
  Vec3 pitch = Vec3::Ones(), origin = region.bounds.min;
  for (int k = 0; k < 3; ++k) {
    if (dimension == 2 && k == 1) continue;
    const double length = region.bounds.max[k] - region.bounds.min[k];
    n[static_cast<std::size_t>(k)] = std::max(1, static_cast<int>(std::lround(length / d)));
    pitch[k] = length / n[static_cast<std::size_t>(k)];
  }
  if (dimension == 2) origin[1] = -0.5;
  const double cell = dimension == 2 ? pitch[0] * pitch[2] : pitch.prod();
  const double near = 0.9 * pitch.norm();
  auto outside = [&](const Vec3& p) { return std::max(region.distance(p), -obstacles.clearance(p)); };
  auto not_air = [&](const Vec3& p) { return std::max(-region.distance(p), -obstacles.clearance(p)); };
  FilledOne out;
  const int margin = static_cast<int>(std::ceil(support / d));
  const int my = dimension == 2 ? 0 : margin;
  std::vector<CutCell> cut;
  for (int iz = -margin; iz < n[2] + margin; ++iz)
    for (int iy = -my; iy < n[1] + my; ++iy)
      for (int ix = -margin; ix < n[0] + margin; ++ix) {
        Vec3 p = origin + Vec3(ix + 0.5, iy + 0.5, iz + 0.5).cwiseProduct(pitch);
        if (dimension == 2) p[1] = 0;
        const double phi = region.distance(p), free = obstacles.clearance(p), s = std::max(phi, -free);
        if (phi < -near)
          out.asked += cell;
        else if (phi < near)
          out.asked += cell * part_of_cell(region.distance, p, pitch, dimension).share;
        if (s < near) {
          const Part part = s < -near ? Part{1, p} : part_of_cell(outside, p, pitch, dimension);
          out.volume += cell * part.share;
          if (part.share > 1 - 1e-6)
            out.sites.push_back(p);
          else if (part.share > 1e-6)
            cut.push_back({{ix, iy, iz}, part});
        }
        if (phi > 0 && phi < support && free > -near) {
          // what neither fluid nor solids fill, so that nothing can be pushed into a gap between ghosts and a solid
          const double air = free > near && phi > near ? 1 : part_of_cell(not_air, p, pitch, dimension).share;
          if (air > 0) out.ghosts.push_back({p, air * cell});
        }
      }
  place_cut(cut, out.sites);
  return out;
}

Record make_record(const Vec3& site, const Fluid& fluid, const Vec3& centre, double top, double volume,
                   const Scene& scene, const Coordinates& coordinates) {
  const Fixed3 at = coordinates.to_fixed(site);
  const double kx = 2 * std::numbers::pi / fluid.vortex_wavelength * site[0];
  const double kz = 2 * std::numbers::pi / fluid.vortex_wavelength * site[2];
  const Vec3 vortices(-std::cos(kx) * std::sin(kz), 0, std::sin(kx) * std::cos(kz));
  const Vec3 v = fluid.velocity + fluid.angular_velocity.cross(site - centre) + fluid.vortex_speed * vortices +
                 fluid.strain * Vec3(site[0] - centre[0], 0, centre[2] - site[2]);
  const double depth = std::max(top - site[2], 0.0);
  const double p = scene.numerics.reduced_gravity ? 0 : -fluid.density * scene.world.gravity[2] * depth;
  return {at[0],
          at[1],
          at[2],
          static_cast<float>(p),
          static_cast<float>(v[0]),
          static_cast<float>(v[1]),
          static_cast<float>(v[2]),
          static_cast<float>(volume)};
}

/// Where the particles are, in cells of a spacing.
class Grid {
 public:
  Grid(const Particles& particles, const Coordinates& coordinates, double cell)
      : coordinates_(coordinates), cell_(cell) {
    for (std::uint32_t f = 0; f < particles.size(); ++f) {
      const Record& r = particles.record[f];
      at_[key(coordinates.to_metres(r.x, r.y, r.z), 0, 0, 0)].push_back({r.x, r.y, r.z});
    }
  }
  /// Is a particle within `reach` <= cell of p?
  bool near(const Vec3& p, double reach) const {
    const Fixed3 own = coordinates_.to_fixed(p);
    for (int k = 0; k < 27; ++k) {
      const auto found = at_.find(key(p, k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
      if (found == at_.end()) continue;
      for (const Fixed3& other : found->second)
        if (coordinates_.difference(own, other).norm() < reach) return true;
    }
    return false;
  }

 private:
  std::int64_t key(const Vec3& p, int dx, int dy, int dz) const {
    const auto along = [&](int axis, int d) {
      return static_cast<std::int64_t>(std::floor((p[axis] - coordinates_.domain.min[axis]) / cell_)) + d + 1;
    };
    return (along(2, dz) * 2097152 + along(1, dy)) * 2097152 + along(0, dx);
  }
  const Coordinates& coordinates_;
  double cell_;
  std::unordered_map<std::int64_t, std::vector<Fixed3>> at_;
};

/// Fluids that touch hold each other: no ghost may stand where the other one's particles are.
void settle_neighbours(const Scene& scene, const Coordinates& coordinates, Filled& filled) {
  const double d = scene.world.spacing;
  const Grid grid(filled.particles, coordinates, d);
  std::erase_if(filled.ghosts,
                [&](const Record& r) { return grid.near(coordinates.to_metres(r.x, r.y, r.z), 0.75 * d); });
}

/// Refuses a fill that reaches into that of an earlier fluid.
Status check_overlap(const Scene& scene, const Fluid& fluid, const std::vector<Vec3>& sites,
                     const std::vector<Region>& earlier) {
  const double inside = -0.05 * scene.world.spacing;  // meshes are not exact
  for (std::size_t k = 0; k < earlier.size(); ++k)
    for (const Vec3& p : sites)
      if (earlier[k].distance(p) < inside)
        return fill_error(fluid,
                          fmt::format("the fill of '{}' overlaps that of '{}' at ({:.3g}, {:.3g}, {:.3g}) m",
                                      fluid.name, scene.fluids[k].name, p[0], p[1], p[2]),
                          "move or shrink one of the fills: each place holds one fluid");
  return ok();
}

}  // namespace

Result<Filled> fill_fluids(const Scene& scene, const std::vector<Body>& bodies, const Coordinates& coordinates,
                           double support) {
  Filled filled;
  const Obstacles obstacles(scene, bodies, 2 * support);
  std::vector<std::optional<Solid>> meshes(scene.fluids.size());
  std::vector<Region> regions;
  for (const Fluid& fluid : scene.fluids) {
    auto region = region_of(scene, bodies, fluid, meshes[regions.size()]);
    if (!region) return region.error();
    const FilledOne one = fill_one(*region, obstacles, scene, support);
    if (one.sites.empty())
      return fill_error(fluid,
                        fmt::format("fluid '{}' has no particle: its fill has a volume of {:.3g} m^3 after carving",
                                    fluid.name, one.volume),
                        "make the fill larger, the spacing smaller, or move the bodies out of it");
    if (Status s = check_overlap(scene, fluid, one.sites, regions); !s) return s.error();
    const double volume = one.volume / static_cast<double>(one.sites.size());
    FluidProperties properties;
    properties.density = static_cast<float>(fluid.density);
    properties.viscosity = static_cast<float>(fluid.viscosity);
    properties.volume = static_cast<float>(volume);
    properties.first_id = static_cast<std::uint32_t>(filled.particles.size());
    properties.count = static_cast<std::uint32_t>(one.sites.size());
    const Vec3 centre = 0.5 * (region->bounds.min + region->bounds.max);
    for (const Vec3& site : one.sites) {
      if (!coordinates.inside(site))
        return fill_error(fluid,
                          fmt::format("fluid '{}' reaches outside the domain at ({:.3g}, {:.3g}, {:.3g}) m", fluid.name,
                                      site[0], site[1], site[2]),
                          "enlarge world.domain or move the fill");
      filled.particles.id.push_back(static_cast<std::uint32_t>(filled.particles.id.size()));
      filled.particles.record.push_back(make_record(site, fluid, centre, region->top, volume, scene, coordinates));
    }
    for (const Ghost& ghost : one.ghosts)
      if (coordinates.inside(ghost.position)) {  // across a periodic border lies fluid, not a ghost
        const Fixed3 at = coordinates.to_fixed(ghost.position);
        filled.ghosts.push_back({at[0], at[1], at[2], 0, 0, 0, 0, static_cast<float>(-ghost.volume)});
      }
    filled.fluids.push_back(properties);
    filled.reports.push_back({fluid.name, one.asked, one.volume, one.asked * fluid.density, one.volume * fluid.density,
                              region->top, one.sites.size()});
    regions.push_back(*std::move(region));
  }
  if (filled.fluids.size() > 1) settle_neighbours(scene, coordinates, filled);
  return filled;
}

}  // namespace ballast::fluid
