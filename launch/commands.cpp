// Commands that look at a scene and simulate nothing.
#include "launch/commands.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/output/columns.h"
#include "launch/prepare.h"
#include "launch/say.h"

namespace ballast::launch {

namespace {

std::string contents(const Prepared& p) {
  const auto count = [&](Motion motion) {
    return std::ranges::count_if(p.scene.models, [&](const Model& m) { return m.motion == motion; });
  };
  const World& world = p.scene.world;
  std::string text = fmt::format("{}: {}-D, {:g} s", p.scene.name, world.dimension, world.duration);
  if (p.fluid)
    text += fmt::format(", spacing {:g} m, about {:.0f} particles of fluid", world.spacing, estimate_particles(p));
  text += fmt::format("; bodies: {} free, {} driven, {} static", count(Motion::kDynamic), count(Motion::kPrescribed),
                      count(Motion::kStatic));
  return text + fmt::format("; {} joints, {} probes, {} expectations", p.scene.joints.size(), p.scene.probes.size(),
                            p.scene.expects.size());
}

/// What the fluid process does in a step, and what it keeps of every particle.
void print_passes(const Scene& scene) {
  const bool implicit = scene.numerics.pressure == Pressure::kImplicit;
  const bool viscous = std::ranges::any_of(scene.fluids, [](const Fluid& f) { return f.viscosity > 0; });
  const auto any = [&](Motion motion) {
    return std::ranges::any_of(scene.models, [=](const Model& m) { return m.motion == motion; });
  };
  const bool free = any(Motion::kDynamic);
  fmt::print("\npasses of a step\n");
  if (free || any(Motion::kPrescribed)) fmt::print("  samples of moving bodies are placed\n");
  fmt::print("  particles are sorted by cell, samples near them merged in{}\n  neighbour lists{}\n",
             scene.numerics.skip_search ? "; while nothing leaves its cell order and lists are kept" : "",
             implicit ? "" : ", and in the same sweep continuity and density diffusion");
  if (implicit) fmt::print("  implicit pressure: rows, and products until it fits\n");
  if (!scene.models.empty())
    fmt::print("  sums of samples, pressure and forces on solids, barrier{}\n", free ? ", films between solids" : "");
  fmt::print("  acceleration: pressure, artificial viscosity{}; motion\n", viscous ? ", viscosity" : "");
  if (scene.numerics.shifting == When::kAlways) fmt::print("  particles are shifted to even distances\n");
  fmt::print("\nfields of a particle\n  position, velocity, pressure, volume, id{}\n", implicit ? ", compression" : "");
  if (viscous) fmt::print("  viscous velocity and viscosity, for a step\n");
}

}  // namespace

int check(const std::string& scene, const Overrides& overrides) {
  auto prepared = prepare(scene, overrides);
  if (!prepared) return fail(prepared.error());
  fmt::print("{}\n", contents(*prepared));
  for (const auto* list : {&prepared->warnings, &prepared->oddities})
    for (const std::string& warning : *list) fmt::print(stderr, "ballast: warning: {}\n", warning);
  return kFine;
}

int resolve(const std::string& scene, const Overrides& overrides) {
  auto read = read_scene(scene, overrides);
  if (!read) return fail(read.error());
  fmt::print("{}", print_scene(*read));
  return kFine;
}

int schema() {
  fmt::print("{}\n", scene_schema());
  return kFine;
}

int plan(const std::string& scene, const Overrides& overrides) {
  auto prepared = prepare(scene, overrides);
  if (!prepared) return fail(prepared.error());
  const Prepared& p = *prepared;
  const Coupling& coupling = p.scene.coupling;
  fmt::print(
      "{}\n\nprocesses\n  coordinator: grants steps, checks both sides against each other, writes rows and record\n",
      contents(p));
  if (p.fluid)
    fmt::print("  fluid_server: pressure and motion of the fluid{}\n", p.rigid ? ", wrenches on the bodies" : "");
  if (p.rigid)
    fmt::print("  rigid_client: engine {}, {} engine step(s) per exchange\n", coupling.engine, coupling.substeps);
  const auto because = [](const std::string& reason) { return reason.empty() ? "" : ": " + reason; };
  if (p.fluid)
    fmt::print("\nsolver\n  {}{}\n", p.scene.numerics.pressure == Pressure::kImplicit ? "implicit" : "wcsph (explicit)",
               because(p.choices.pressure_reason));
  if (p.fluid && p.rigid) {
    fmt::print(
        "\nexchange\n  scheme {}{}\n  every step: states and mobilities to the fluid, wrenches{} to the engine\n",
        coupling.scheme, because(p.choices.scheme_reason), p.contact_sets ? " and contact sets" : "");
  }
  if (p.fluid) print_passes(p.scene);
  if (p.scene.world.sleep_speed > 0)
    fmt::print("\nat rest: nothing faster than {:g} m/s for {:g} s: steps are slept through\n",
               p.scene.world.sleep_speed, p.scene.world.sleep_after);
  fmt::print("\noutputs, every {:g} s\n  record.json: once, at the end\n", p.scene.output.every);
  if (p.rigid) fmt::print("  bodies.csv: {} columns\n", 1 + output::body_columns(p.scene).size());
  if (!p.scene.probes.empty()) fmt::print("  probes.csv: {} columns\n", 1 + output::probe_columns(p.scene).size());
  if (p.scene.output.vtk) fmt::print("  vtk/: ParaView files at every row\n");
  if (p.scene.output.picture) fmt::print("  picture.png: the last state\n");
  if (p.scene.output.lcm) {
    fmt::print("  over LCM: status, warnings{}{}{}{}\n", p.rigid ? ", bodies" : "", p.fluid ? ", fluid" : "",
               p.fluid && p.rigid ? (p.contacts_shown ? ", wrenches, contacts" : ", wrenches") : "",
               p.fluid && p.scene.output.lcm_particles > 0
                   ? fmt::format(", at most {} particles a frame", p.scene.output.lcm_particles)
                   : "");
  }
  fmt::print("\nleft out\n");
  for (const LeftOut& l : p.left_out) {
    fmt::print("  {}: {}; saves {}; difference: {}\n", l.what, l.why, l.saved, l.difference);
  }
  if (p.left_out.empty()) fmt::print("  nothing\n");
  return kFine;
}

}  // namespace ballast::launch
