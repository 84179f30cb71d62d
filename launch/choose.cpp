// The rules of `auto`. Figures behind them: README.md.
#include "launch/choose.h"

#include <algorithm>
#include <cmath>

namespace ballast::launch {

namespace {

bool moves_freely(const Scene& scene, const std::string& name) {
  return std::ranges::any_of(scene.models,
                             [&](const Model& m) { return m.name == name && m.motion == Motion::kDynamic; });
}

/// Has the fluid no free surface, as far as a look at the scene tells?
bool is_closed(const Scene& scene) {
  if (scene.numerics.reduced_gravity) return true;
  const auto& periodic = scene.world.periodic;
  if (periodic[0] && periodic[2] && (scene.world.dimension == 2 || periodic[1])) return true;
  return std::ranges::all_of(scene.fluids, [&](const Fluid& fluid) {
    const auto container = std::ranges::find(scene.models, fluid.fill.container, &Model::name);
    return fluid.fill.kind == FillKind::kLevel && container != scene.models.end() &&
           (container->shape.hollow || container->shape.lid);
  });
}

bool has_free_bodies(const Scene& scene) {
  return std::ranges::any_of(scene.models, [](const Model& m) { return m.motion == Motion::kDynamic; });
}

/// Do viscous forces bound the step of either solver? Then the implicit one's cost more, and are no longer.
bool is_viscous(const Scene& scene) {
  const double d = scene.world.spacing, free = 0.2 * std::sqrt(d / scene.world.gravity.norm());
  return std::ranges::any_of(scene.fluids, [&](const Fluid& f) { return d * d / 8 < free * f.viscosity / f.density; });
}

/// Is the implicit solver the better choice? Measured in still water and dam breaks: README.md. Keys that only the
/// explicit one knows ask for that.
bool implicit_pays(const Scene& scene) {
  const bool asks_for_explicit = scene.numerics.courant > 0 || scene.numerics.diffusion != Numerics{}.diffusion ||
                                 scene.world.attraction_rate > 0 || scene.coupling.scheme == "staggered";
  return scene.world.accuracy == Accuracy::kInteractive && scene.world.dimension == 3 && !has_free_bodies(scene) &&
         !scene.world.gravity.isZero(0) && !is_closed(scene) && !is_viscous(scene) && !asks_for_explicit;
}

/// Why the explicit solver, for this scene.
std::string why_explicit(const Scene& scene) {
  if (has_free_bodies(scene))
    return "bodies move freely, and which solver is the better one then hangs on the scene: the implicit one has to be "
           "asked for";
  if (scene.world.accuracy != Accuracy::kInteractive)
    return "the implicit solver takes half to twice as long here, and its pressure at rest is noisier";
  return "the implicit solver is chosen by itself only in 3-D, for a fluid with weight, a surface, and little "
         "viscosity";
}

}  // namespace

Choices choose(Scene& scene) {
  Choices choices;
  if (scene.fluids.empty()) return choices;
  if (scene.numerics.pressure == Pressure::kAuto) {
    const bool implicit = implicit_pays(scene);
    scene.numerics.pressure = implicit ? Pressure::kImplicit : Pressure::kWcsph;
    choices.pressure_reason = implicit
                                  ? "nothing moves freely here, and it takes a quarter to two thirds of the explicit "
                                    "solver's time, with a smaller error of the density"
                                  : why_explicit(scene);
  }
  if (scene.numerics.shifting == When::kAuto) {
    const bool weightless = scene.numerics.reduced_gravity || scene.world.gravity.isZero(0);
    // Short steps, which shifting needs there, leave the implicit solver too little time to part the particles of jets.
    const bool shifts = weightless && (scene.numerics.pressure != Pressure::kImplicit || is_closed(scene));
    scene.numerics.shifting = shifts ? When::kAlways : When::kNever;
    choices.shifting_reason = shifts ? "no weight presses the particles together, and their lattice would tear"
                              : weightless
                                  ? "the fluid has a surface, and the implicit solver's steps would get too short"
                                  : "their weight presses the particles together";
  }
  if (scene.coupling.scheme != "auto") return choices;
  const auto joint = std::ranges::find_if(scene.joints, [&](const Joint& j) {
    if (j.kind == JointKind::kFixed && !moves_freely(scene, j.parent)) return false;  // held: it does not move at all
    return moves_freely(scene, j.child) || moves_freely(scene, j.parent);
  });
  if (joint != scene.joints.end()) {
    scene.coupling.scheme = "iterated";
    choices.scheme_reason =
        "joint '" + joint->name + "' bears what the fluid cannot foresee, and few repetitions settle it";
  } else if (std::ranges::any_of(scene.models, [](const Model& m) { return m.motion != Motion::kStatic; })) {
    scene.coupling.scheme = "interlinked";
    choices.scheme_reason = "one exchange a step is exact for bodies without joints, but where they touch";
  }
  return choices;
}

}  // namespace ballast::launch
