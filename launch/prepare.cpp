// What a scene needs: processes, outputs, particles; and what is left out, with the reason.
#include "launch/prepare.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace ballast::launch {

namespace {

/// Passes and fields of the fluid.
void find_left_out_of_fluid(const Prepared& prepared, std::vector<LeftOut>& out) {
  const Scene& scene = prepared.scene;
  const auto any = [&](auto differs) { return std::ranges::any_of(scene.fluids, differs); };
  if (!any([](const Fluid& f) { return f.viscosity > 0; }))
    out.push_back({kViscous, "no fluid has viscosity", "terms in two passes, and a velocity per particle",
                   "none: they would be zero"});
  if (!any([&](const Fluid& f) { return f.density != scene.fluids[0].density; }))
    out.push_back({kDensities, "all fluid has one density", "a number per particle", "none: one number says it"});
  if (!std::ranges::any_of(scene.models, [](const Model& m) { return m.motion == Motion::kDynamic; }))
    out.push_back({kFilms, "no body moves freely", "a solve of the pressure between them, and its samples",
                   "none: nothing could be lifted"});
  if (scene.numerics.shifting == When::kNever)
    out.push_back(
        {kShifting,
         prepared.choices.shifting_reason.empty() ? "numerics.shifting is never" : prepared.choices.shifting_reason,
         "two passes over the fluid", "where no weight holds them, the lattice of the particles tears"});
  if (scene.numerics.pressure != Pressure::kImplicit)
    out.push_back({kCompression, "numerics.pressure is not implicit", "its solver, and a number per particle",
                   "none: the explicit solver needs neither"});
}

std::vector<LeftOut> find_left_out(const Prepared& prepared) {
  const Scene& scene = prepared.scene;
  const bool fluid = prepared.fluid, rigid = prepared.rigid;
  std::vector<LeftOut> out;
  if (!fluid) {
    out.push_back({kFluidProcess, "no fluid in this scene", "one process with all its memory, and every exchange",
                   "none: nothing would act on the bodies"});
  }
  if (!rigid) {
    out.push_back({kRigidProcess, "every model is static", "one process, and every exchange", "none: nothing moves"});
  }
  if (fluid) find_left_out_of_fluid(prepared, out);
  if (fluid && rigid && !prepared.contact_sets) {
    out.push_back({kContactSets,
                   scene.coupling.contact_sets == When::kNever ? "coupling.contact_sets is never"
                   : prepared.contacts_shown ? "only messages show them: assembled when one is due, not in every step"
                                             : "nobody reads them: output.lcm is false (--lcm), and "
                                               "engines take wrenches (coupling.contact_sets: always)",
                   "a pass over the wetted samples of every step, and a ring for it",
                   "none: wrenches are exact without them"});
  }
  if (std::ranges::any_of(scene.fluids, [](const Fluid& f) { return f.surface_tension > 0; })) {
    out.push_back({"surface tension", "the fluid has no such term yet: fluids.*.surface_tension is not used",
                   "one pass over the fluid", "capillary forces, which matter below about a centimetre in water"});
  }
  if (scene.probes.empty()) out.push_back({"probes.csv", "the scene has no probes", "one file and its sums", "none"});
  if (!scene.output.lcm) {
    out.push_back({kMessages, "output.lcm is false (--lcm)", "one thread, a queue, and frames for monitors in the ring",
                   "none: monitors only watch"});
  } else if (fluid && scene.output.lcm_particles == 0) {
    out.push_back({"messages of particles", "output.lcm_particles is 0", "a pass over the particles per output time",
                   "none: monitors only watch"});
  }
  if (!(scene.output.checkpoint_every > 0)) {
    out.push_back({"checkpoints", "output.checkpoint.every is 0 (--checkpoint TIME)",
                   "a file of the state per process and interval", "none; a run that is killed starts anew"});
  }
  if (!scene.output.vtk) out.push_back({kVtk, "output.vtk is false", "two files per output time", "none"});
  if (!scene.output.picture)
    out.push_back({"picture.png", "output.picture is false", "one rendering at the end", "none"});
  return out;
}

/// World box around a posed local box.
Box3 posed(const Box3& local, const Pose& pose) {
  Eigen::AlignedBox3d box;
  for (int c = 0; c < 8; ++c) {
    const Vec3 corner((c & 1) ? local.max.x() : local.min.x(), (c & 2) ? local.max.y() : local.min.y(),
                      (c & 4) ? local.max.z() : local.min.z());
    box.extend(pose.position + pose.rotation * corner);
  }
  return {box.min(), box.max()};
}

// Spacings that one fill may reach into another: faces that ought to be the same. What samples miss, the fluid process
// finds.
constexpr double kShared = 0.2;

/// What a sampling of a fill finds.
struct Sampled {
  double volume = 0;                  ///< less the bodies in it, m^3
  double spilled = 0;                 ///< share of it that no container holds, where there are containers
  std::optional<Vec3> out_of_domain;  ///< a place of it that world.domain does not have
  std::optional<std::pair<std::string, Vec3>> shared;  ///< an earlier fluid, and a place that both would fill
};

/// Is the point in the room of a container that stays where it is, or is there none?
bool is_held(const Prepared& p, const Vec3& x) {
  bool contained = false;
  for (std::size_t b = 0; b < p.bodies.size(); ++b) {
    const Body& body = p.bodies[b];
    if (!body.solid.is_container() || p.scene.models[b].motion == Motion::kDynamic) continue;
    contained = true;
    if (body.solid.room_distance(body.pose.rotation.conjugate() * (x - body.pose.position)) < 0) return true;
  }
  return !contained;
}

bool in_domain(const World& world, const Vec3& x) {
  if (!world.domain) return true;
  for (int k = 0; k < 3; ++k)
    if (!(world.dimension == 2 && k == 1) && (x[k] < world.domain->min[k] || x[k] > world.domain->max[k])) return false;
  return true;
}

Result<Solid> mesh_of(const Fluid& fluid, const World& world) {
  Shape shape;
  shape.kind = ShapeKind::kMesh;
  shape.mesh = fluid.fill.mesh;
  shape.scale = fluid.fill.scale;
  return Solid::make(shape, world.dimension, world.spacing, false);
}

/// The room that a fluid asks for; check_shape has accepted its shape.
class FillRoom {
 public:
  FillRoom(const Fluid& fluid, const Prepared& p) : fluid_(&fluid) {
    box_ = fluid.fill.box;
    if (fluid.fill.kind == FillKind::kBox) {
      if (p.scene.world.dimension == 2) box_.min.y() = -1e300, box_.max.y() = 1e300;
    } else if (fluid.fill.kind == FillKind::kMesh) {
      mesh_.emplace(*mesh_of(fluid, p.scene.world));
      box_ = posed(mesh_->bounds(), fluid.fill.pose);
    } else {
      const auto found = std::ranges::find(p.scene.models, fluid.fill.container, &Model::name);
      if (found == p.scene.models.end()) return;  // an empty room, which is refused
      container_ = &p.bodies[static_cast<std::size_t>(found - p.scene.models.begin())];
      box_ = posed(container_->solid.bounds(), container_->pose);
      box_.max.z() = std::min(box_.max.z(), fluid.fill.level);
    }
  }
  const std::string& fluid() const { return fluid_->name; }
  const Box3& bounds() const { return box_; }
  /// Of a point of the world, m, negative inside; only its sign and the depth inside are exact.
  double distance(const Vec3& x) const {
    const double to_box = (box_.min - x).cwiseMax(x - box_.max).maxCoeff();
    if (mesh_) return mesh_->distance(fluid_->fill.pose.rotation.conjugate() * (x - fluid_->fill.pose.position));
    if (!container_) return to_box;
    const Pose& pose = container_->pose;
    return std::max(to_box, container_->solid.room_distance(pose.rotation.conjugate() * (x - pose.position)));
  }

 private:
  const Fluid* fluid_;
  std::optional<Solid> mesh_;
  const Body* container_ = nullptr;
  Box3 box_;
};

Sampled sample_fill(const FillRoom& room, const std::vector<FillRoom>& earlier, const Prepared& p) {
  const bool flat = p.scene.world.dimension == 2;
  const Box3& box = room.bounds();
  Vec3 low = box.min, size = box.max - box.min;
  if (flat) low.y() = -0.5, size.y() = 1;
  if (size.minCoeff() <= 0) return {};
  const double step = flat ? std::sqrt(size.x() * size.z() / 60000) : std::cbrt(size.prod() / 60000);
  const auto cells = [&](double edge) { return std::max(1, static_cast<int>(std::lround(edge / step))); };
  const int nx = cells(size.x()), ny = flat ? 1 : cells(size.y()), nz = cells(size.z());
  long inside = 0, spilled = 0;
  Sampled out;
  for (int i = 0; i < nx * ny * nz; ++i) {
    const Vec3 at((i % nx + 0.5) / nx, (i / nx % ny + 0.5) / ny, (i / nx / ny + 0.5) / nz);
    const Vec3 x = low + at.cwiseProduct(size);
    if (room.distance(x) >= 0) continue;
    const bool in_body = std::ranges::any_of(p.bodies, [&](const Body& body) {
      return body.solid.distance(body.pose.rotation.conjugate() * (x - body.pose.position)) < 0;
    });
    if (in_body) continue;
    ++inside;
    if (!is_held(p, x)) ++spilled;
    if (!in_domain(p.scene.world, x)) out.out_of_domain = x;
    for (const FillRoom& other : earlier)
      if (other.distance(x) < -kShared * p.scene.world.spacing) out.shared = {other.fluid(), x};
  }
  out.volume = size.prod() * static_cast<double>(inside) / (static_cast<double>(nx) * ny * nz);
  out.spilled = inside > 0 ? static_cast<double>(spilled) / static_cast<double>(inside) : 0;
  return out;
}

}  // namespace

namespace {

std::string where(const Place& place) { return fmt::format("{}:{}:{}", place.file, place.line, place.column); }

/// Refuses a mesh that encloses no room, and a level above the rim of its container.
Status check_shape(const Fluid& fluid, const Prepared& p) {
  if (fluid.fill.kind == FillKind::kMesh) {
    auto mesh = mesh_of(fluid, p.scene.world);
    if (!mesh) return Error{mesh.error().what, mesh.error().cure, where(fluid.place)};
  }
  if (fluid.fill.kind != FillKind::kLevel) return ok();
  const auto model = std::ranges::find(p.scene.models, fluid.fill.container, &Model::name);
  if (model == p.scene.models.end() || model->shape.kind != ShapeKind::kOpenBox || model->shape.lid) return ok();
  const double rim = posed(Box3{Vec3::Zero(), model->shape.size}, model->pose).max.z();
  if (fluid.fill.level <= rim + 1e-9 * std::abs(rim)) return ok();
  return Error{fmt::format("the level z = {:.3g} m of fluid '{}' lies above the rim of '{}' at z = {:.3g} m",
                           fluid.fill.level, fluid.name, model->name, rim),
               "lower the level, or make the container higher", where(fluid.place)};
}

/// Refuses a fluid without volume, of a handful of particles, or outside world.domain.
Status check_fill(const Fluid& fluid, const Sampled& fill, const World& world) {
  const double cell = std::pow(world.spacing, world.dimension), least = std::pow(3, world.dimension);
  if (!(fill.volume > 0.5 * cell))
    return Error{fmt::format("fluid '{}' would fill {:.3g} m^3 once bodies are carved out, less than a particle of "
                             "{:.3g} m^3",
                             fluid.name, fill.volume, cell),
                 "move its fill to where there is room, or make world.spacing smaller", where(fluid.place)};
  if (fill.volume < least * cell)
    return Error{fmt::format("fluid '{}' would have about {:.0f} particles of spacing {:.3g} m, too few to flow",
                             fluid.name, fill.volume / cell, world.spacing),
                 fmt::format("make world.spacing smaller, {:.2g} m or less, or the fill larger",
                             std::pow(fill.volume / (8 * least), 1.0 / world.dimension)),
                 where(fluid.place)};
  if (const auto& x = fill.out_of_domain)
    return Error{fmt::format("the fill of '{}' reaches outside world.domain, at ({:.3g}, {:.3g}, {:.3g}) m", fluid.name,
                             x->x(), x->y(), x->z()),
                 "enlarge world.domain or move the fill", where(fluid.place)};
  return ok();
}

/// Refuses what check_fill does, and more particles than the machine can hold; warns of fluid that nothing holds.
Status check_fluids(Prepared& prepared, const std::string& scene_file) {
  const World& world = prepared.scene.world;
  double particles = 0;
  std::vector<FillRoom> rooms;
  for (const Fluid& fluid : prepared.scene.fluids) {
    if (Status s = check_shape(fluid, prepared); !s) return s;
    FillRoom room(fluid, prepared);
    const Sampled fill = sample_fill(room, rooms, prepared);
    if (Status s = check_fill(fluid, fill, world); !s) return s;
    if (fill.shared) {
      const auto& [other, x] = *fill.shared;
      return Error{fmt::format("the fills of '{}' and '{}' overlap, at ({:.3g}, {:.3g}, {:.3g}) m", other, fluid.name,
                               x.x(), x.y(), x.z()),
                   "move or shrink one of them: each place holds one fluid", where(fluid.place)};
    }
    rooms.push_back(std::move(room));
    if (fill.spilled > 0)
      prepared.warnings.push_back(fmt::format(
          "{}: about {:.2g} % of the fluid '{}' starts outside every container: it falls or flows away, and "
          "counts as lost where it leaves the domain; shrink its fill, or make the container larger",
          where(fluid.place), 100 * fill.spilled, fluid.name));
    particles += fill.volume / std::pow(world.spacing, world.dimension);
  }
  const std::string place = prepared.scene.fluids.empty() ? scene_file : where(prepared.scene.fluids[0].place);
  const std::string cure = fmt::format("make world.spacing ({:.3g} m) larger or the fills smaller", world.spacing);
  if (particles > 2e9)
    return Error{fmt::format("the fluid would have about {:.2g} particles; 2e9 is the most", particles), cure, place};
  // Measured: ballast bench, and its solver's share in 3-D.
  const double each = prepared.scene.numerics.pressure == Pressure::kImplicit ? 2000 : 600;
  const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  if (particles * each > memory)
    return Error{fmt::format("the fluid would have about {:.2g} particles and need about {:.3g} GB; this machine has "
                             "{:.3g} GB of memory",
                             particles, particles * each * 1e-9, memory * 1e-9),
                 cure, place};
  return ok();
}

/// Refuses bodies that start across a periodic border: they would be carved and sampled on one side of it only. Warns
/// that bodies do not meet each other across it.
Status check_borders(Prepared& prepared) {
  const World& world = prepared.scene.world;
  if (!world.domain) return ok();
  for (int k = 0; k < 3; ++k) {
    if (!world.periodic[static_cast<std::size_t>(k)] || (world.dimension == 2 && k == 1)) continue;
    std::size_t movable = 0;
    for (std::size_t b = 0; b < prepared.bodies.size(); ++b) {
      const Model& model = prepared.scene.models[b];
      if (model.motion == Motion::kStatic) continue;
      ++movable;
      const Box3 box = posed(prepared.bodies[b].solid.bounds(), prepared.bodies[b].pose);
      const double low = world.domain->min[k], high = world.domain->max[k], tiny = 1e-9 * (high - low);
      if (box.min[k] < low - tiny || box.max[k] > high + tiny)
        return Error{
            fmt::format("the body '{}' reaches from {} = {:.3g} to {:.3g} m, across the periodic border at {:.3g} m",
                        model.name, "xyz"[k], box.min[k], box.max[k], box.min[k] < low ? low : high),
            "move it, or world.domain, so that it starts inside: later it may cross the border", where(model.place)};
    }
    if (movable > 1)
      prepared.warnings.push_back(fmt::format(
          "bodies do not meet each other across the periodic border of {}: there they pass through each other",
          "xyz"[k]));
  }
  return ok();
}

}  // namespace

double estimate_particles(const Prepared& prepared) {
  double volume = 0;
  for (const Fluid& fluid : prepared.scene.fluids)
    volume += sample_fill(FillRoom(fluid, prepared), {}, prepared).volume;
  return volume / std::pow(prepared.scene.world.spacing, prepared.scene.world.dimension);
}

Result<Prepared> prepare(const std::string& scene_file, const Overrides& overrides) {
  auto scene = read_scene(scene_file, overrides);
  if (!scene) return scene.error();
  return prepare(std::move(*scene), scene_file);
}

Result<Prepared> prepare(Scene scene, const std::string& scene_file) {
  auto bodies = make_bodies(scene);
  if (!bodies) return bodies.error();
  Prepared out{std::move(scene), std::move(*bodies), false, false, {}};
  out.choices = choose(out.scene);
  out.fluid = !out.scene.fluids.empty();
  out.rigid = std::ranges::any_of(out.scene.models, [](const Model& m) { return m.motion != Motion::kStatic; });
  if (!out.fluid && !out.rigid) {
    return Error{"there is nothing to simulate: no fluid and no model that moves",
                 "add a fluid or a model that is not static", scene_file};
  }
  if (out.scene.coupling.engine == "free_body" && !out.scene.joints.empty()) {
    const Joint& joint = out.scene.joints[0];
    return Error{fmt::format("engine free_body has no joints, but joint '{}' is in the scene", joint.name),
                 "use coupling.engine: ode, or remove the joint", where(joint.place)};
  }
  if (auto checked = check_borders(out); !checked) return checked.error();
  if (auto checked = check_fluids(out, scene_file); !checked) return checked.error();
  if (auto checked = check_probes(out.scene, out.bodies); !checked) return checked.error();
  out.oddities = odd_bodies(out);
  const When wanted = out.scene.coupling.contact_sets;
  out.contact_sets = out.fluid && out.rigid && wanted == When::kAlways;
  out.contacts_shown = out.fluid && out.rigid && wanted != When::kNever && out.scene.output.lcm;
  out.left_out = find_left_out(out);
  return out;
}

std::string in_the_file(const Prepared& prepared, const std::string& message) {
  for (const Fluid& fluid : prepared.scene.fluids)
    if (const std::string path = "fluids." + fluid.name + ": "; message.starts_with(path))
      return fmt::format("{}: {}", where(fluid.place), message.substr(path.size()));
  return message;
}

void expect_foreign_engine(Prepared& prepared) {
  prepared.contact_sets = prepared.fluid && prepared.rigid && prepared.scene.coupling.contact_sets != When::kNever;
  prepared.left_out = find_left_out(prepared);
}

}  // namespace ballast::launch
