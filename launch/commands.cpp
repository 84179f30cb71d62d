// Commands that look at a scene and simulate nothing.
#include "launch/commands.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/output/columns.h"
#include "launch/prepare.h"

namespace ballast::launch {

namespace {

int fail(const Error& error) {
  fmt::print(stderr, "ballast: {}\n", error.text());
  return error.exit_code;
}

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

}  // namespace

int check(const std::string& scene, const Overrides& overrides) {
  auto prepared = prepare(scene, overrides);
  if (!prepared) return fail(prepared.error());
  fmt::print("{}\n", contents(*prepared));
  for (const std::string& warning : prepared->warnings) fmt::print(stderr, "ballast: warning: {}\n", warning);
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
  if (p.fluid && p.rigid) {
    fmt::print("\nexchange\n  scheme {}; every step: states and mobilities to the fluid, wrenches{} to the engine\n",
               coupling.scheme, coupling.contact_sets ? " and contact sets" : "");
  }
  fmt::print("\noutputs, every {:g} s\n  record.json: once, at the end\n", p.scene.output.every);
  if (p.rigid) fmt::print("  bodies.csv: {} columns\n", 1 + output::body_columns(p.scene).size());
  if (!p.scene.probes.empty()) fmt::print("  probes.csv: {} columns\n", 1 + output::probe_columns(p.scene).size());
  if (p.scene.output.vtk) fmt::print("  vtk/: ParaView files at every row\n");
  if (p.scene.output.picture) fmt::print("  picture.png: the last state\n");
  if (p.scene.output.lcm) {
    fmt::print("  over LCM: status, warnings{}{}{}{}\n", p.rigid ? ", bodies" : "", p.fluid ? ", fluid" : "",
               p.fluid && p.rigid ? (coupling.contact_sets ? ", wrenches, contacts" : ", wrenches") : "",
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
