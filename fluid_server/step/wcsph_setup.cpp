// Setting up the weakly compressible fluid: domain, sound speed, fill, relaxed start.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "fluid_server/step/accuracy.h"
#include "fluid_server/step/wcsph.h"

namespace ballast::fluid {

namespace {

void extend(Box3& box, const Vec3& p) {
  box.min = box.min.cwiseMin(p);
  box.max = box.max.cwiseMax(p);
}

Box3 occupied_box(const Scene& scene, const std::vector<Body>& bodies) {
  Box3 box{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
  for (const Fluid& fluid : scene.fluids)
    if (fluid.fill.kind == FillKind::kBox)
      extend(box, fluid.fill.box.min), extend(box, fluid.fill.box.max);
    else if (fluid.fill.kind == FillKind::kMesh)
      extend(box, fluid.fill.pose.position);
  for (const Body& body : bodies) {
    const Box3 local = body.solid.bounds();
    if (!local.min.allFinite() || !local.max.allFinite() || local.min.norm() > 1e100) continue;
    for (int corner = 0; corner < 8; ++corner)
      extend(box, body.pose.position + body.pose.rotation * Vec3((corner & 1 ? local.max : local.min)[0],
                                                                 (corner & 2 ? local.max : local.min)[1],
                                                                 (corner & 4 ? local.max : local.min)[2]));
  }
  return box;
}

/// As many threads as there are cores, but none for less than 500 particles: 700 of them are a third faster on one
/// thread than on two, 1,100 a third slower.
int choose_threads(std::size_t particles) {
  constexpr std::size_t kLeast = 500;
  return static_cast<int>(
      std::clamp<std::size_t>(particles / kLeast, 1, std::max(1u, std::thread::hardware_concurrency())));
}

}  // namespace

Box3 choose_domain(const Scene& scene, const std::vector<Body>& bodies, double support) {
  Box3 box = occupied_box(scene, bodies);
  const Vec3 size = box.max - box.min;
  const double margin = 3 * support;
  Box3 domain{box.min.array() - margin, box.max.array() + margin};
  domain.max[2] += 1.5 * size[2];  // splashes rise higher than the water stood
  if (scene.world.domain) {
    for (int k = 0; k < 3; ++k) domain.min[k] = scene.world.domain->min[k], domain.max[k] = scene.world.domain->max[k];
  }
  if (scene.world.dimension == 2) domain.min[1] = -0.5, domain.max[1] = 0.5;
  return domain;
}

double choose_sound_speed(const Scene& scene, const std::vector<Body>& bodies, const Filled& filled) {
  if (scene.numerics.sound_speed > 0) return scene.numerics.sound_speed;
  double speed = 0, top = -1e300;
  for (const Fluid& fluid : scene.fluids) speed = std::max(speed, fluid.velocity.norm());
  for (const FillReport& report : filled.reports) top = std::max(top, report.top);
  double bottom = 1e300;
  for (const Fluid& fluid : scene.fluids)
    if (fluid.fill.kind == FillKind::kBox) bottom = std::min(bottom, fluid.fill.box.min[2]);
  const Box3 box = occupied_box(scene, bodies);
  if (bottom > 1e299) bottom = box.min[2];
  double size = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (scene.models[b].motion == Motion::kStatic) continue;
    speed = std::max(speed, scene.models[b].velocity.norm());
    const Box3 local = bodies[b].solid.bounds();
    const double reach = 0.5 * (local.max - local.min).norm();
    size = std::max(size, reach);
    speed = std::max(speed, scene.models[b].angular_velocity.norm() * reach);
    const Prescription& drive = scene.models[b].prescription;
    speed = std::max(speed, drive.velocity.norm() + drive.angular_velocity.norm() * reach +
                                drive.amplitude.norm() * 2 * M_PI * drive.frequency);
  }
  const double depth = std::max(top - bottom, scene.world.spacing);
  const double fall = std::sqrt(scene.world.gravity.norm() * depth);
  speed = std::max({speed, fall, 1e-3 * scene.world.spacing});
  return 10 * speed;
}

Kernel choose_kernel(const Scene& scene) {
  constexpr double kShortest = 2.1;  // support of a Wendland kernel, in spacings, that keeps a lattice: README.md
  KernelKind kind = scene.numerics.kernel;
  double support = scene.numerics.support;
  if (kind == KernelKind::kAuto) {
    const bool brief = scene.world.dimension == 3 && settings_of(scene.world.accuracy).brief_in_3d;
    const bool implicit = scene.numerics.pressure == Pressure::kImplicit;
    kind = brief && !implicit ? KernelKind::kCubic : KernelKind::kWendland;
    if (brief && implicit && support == 0) support = kShortest;
  }
  return Kernel::of(kind, scene.world.dimension, scene.world.spacing, support);
}

double gravity_step(const Scene& scene) {
  const double gravity = scene.world.gravity.norm();
  if (gravity == 0) return 1e300;
  return settings_of(scene.world.accuracy).gravity_share * std::sqrt(scene.world.spacing / gravity);
}

Result<std::unique_ptr<WcsphFluid>> WcsphFluid::make(const Scene& scene, const std::vector<Body>& bodies, int threads,
                                                     std::function<void()> sign_of_life, bool relax_start) {
  std::unique_ptr<WcsphFluid> fluid(new WcsphFluid);
  WcsphFluid& self = *fluid;
  self.sign_of_life_ = std::move(sign_of_life);
  self.spacing_ = scene.world.spacing;
  const AccuracyClass settings = settings_of(scene.world.accuracy);
  const Kernel kernel = choose_kernel(scene);
  self.constants_.kernel = kernel;
  self.constants_.diffusion = static_cast<float>(scene.numerics.diffusion);
  // Implicit pressure stops what meets within the step; beside it the ram pressure of such long steps shakes light
  // bodies.
  self.constants_.ram_on_samples = scene.numerics.pressure != Pressure::kImplicit;
  self.constants_.artificial_viscosity = static_cast<float>(scene.numerics.artificial_viscosity);
  const Vec3 gravity = scene.numerics.reduced_gravity ? Vec3::Zero() : scene.world.gravity;
  for (int k = 0; k < 3; ++k) self.constants_.gravity[k] = static_cast<float>(gravity[k]);
  if (scene.world.dimension == 2) self.constants_.gravity[1] = 0;
  self.attraction_rate_ = scene.world.attraction_rate, self.attraction_centre_ = scene.world.attraction_centre;
  self.scheme_ = scene.coupling.scheme == "staggered" ? Scheme::kStaggered : Scheme::kInterlinked;
  self.coordinates_ = Coordinates::make(choose_domain(scene, bodies, kernel.support), scene.world.periodic);
  for (int k = 0; k < 3; ++k)
    if (scene.world.periodic[k] &&
        self.coordinates_.domain.max[k] - self.coordinates_.domain.min[k] < 3 * kernel.support)
      return Error{
          fmt::format(
              "the domain is {:.3g} m long on its periodic axis {}, less than three kernel supports of {:.3g} m",
              self.coordinates_.domain.max[k] - self.coordinates_.domain.min[k], "xyz"[k], kernel.support),
          "make world.domain longer or world.spacing smaller", ""};
  self.sign_of_life_();
  auto filled = fill_fluids(scene, bodies, self.coordinates_, kernel.support);
  if (!filled) return filled.error();
  self.filled_ = *std::move(filled);
  if (threads < 1) threads = choose_threads(self.filled_.particles.size());
  self.constants_.threads = threads;
  for (const FluidProperties& one : self.filled_.fluids) {
    self.constants_.several_densities |= one.density != self.filled_.fluids[0].density;
    self.kinematic_viscosity_ = std::max(self.kinematic_viscosity_, static_cast<double>(one.viscosity) / one.density);
    self.constants_.viscous |= one.viscosity > 0;
  }
  self.extras_.density.assign(1, self.filled_.fluids[0].density);
  self.constants_.sound_speed = static_cast<float>(choose_sound_speed(scene, bodies, self.filled_));

  self.sign_of_life_();
  self.samples_ = std::make_unique<Samples>(
      Samples::make(scene, bodies, self.coordinates_, kernel.support - 0.5 * scene.world.spacing));
  self.particles_ = std::move(self.filled_.particles);
  if (scene.numerics.shifting == When::kAlways) {
    const bool held = std::ranges::count(scene.world.periodic, true) > 0 ||
                      std::ranges::any_of(scene.models, [](const Model& m) { return m.motion != Motion::kDynamic; });
    self.shifting_ = std::make_unique<Shifting>(self.spacing_, held);
  }
  if (scene.numerics.relax && relax_start) {
    std::vector<Record> solid(self.samples_->record.begin(), self.samples_->record.end());
    std::erase_if(solid, [](const Record& r) { return r.volume == 0; });
    solid.insert(solid.end(), self.filled_.ghosts.begin(), self.filled_.ghosts.end());
    self.relax_report_ = relax(self.particles_, solid, self.coordinates_, self.constants_, self.spacing_,
                               self.shifting_ != nullptr, 1000, self.sign_of_life_);
  }
  self.filled_.ghosts = {};
  self.items_ = std::make_unique<Neighbourhood>(self.coordinates_, kernel.support, kernel.dimension, threads);
  self.items_->set_static_samples(self.samples_->fixed());
  self.items_->may_keep = scene.numerics.skip_search;
  std::vector<Vec3> buoyancy(bodies.size(), Vec3::Zero());
  if (scene.numerics.reduced_gravity)
    for (std::size_t b = 0; b < bodies.size(); ++b)
      if (scene.models[b].motion == Motion::kDynamic)
        buoyancy[b] = -self.filled_.fluids[0].density * bodies[b].solid.mass_properties().volume * scene.world.gravity;
  std::unique_ptr<Seepage> films;
  if (std::ranges::any_of(scene.models, [](const Model& m) { return m.motion == Motion::kDynamic; }))
    films = std::make_unique<Seepage>(scene, *self.samples_, bodies, kernel, gravity, self.filled_.fluids[0].density,
                                      threads);
  self.response_ =
      std::make_unique<Response>(*self.samples_, std::move(buoyancy), std::move(films), self.spacing_, threads);
  self.contacts_every_step_ = scene.coupling.contact_sets == When::kAlways;
  self.barrier_ =
      std::make_unique<Barrier>(*self.samples_, bodies, self.spacing_, scene.numerics.pressure != Pressure::kImplicit);
  if (scene.numerics.pressure == Pressure::kImplicit) {
    self.implicit_ = std::make_unique<ImplicitPressure>(*self.samples_, kernel, self.spacing_);
    self.particles_.has_compression = true;
    self.particles_.compression.assign(self.particles_.size(), 0.f);
    self.tolerance_ = settings.tolerance * settings.gravity_share * settings.gravity_share;
    self.gravity_step_ = scene.world.gravity.norm() > 0 ? gravity_step(scene) : 0;
    self.lattice_stiffness_ = lattice_stiffness(kernel, self.spacing_);
    self.implicit_options_.body_tolerance = settings.body_tolerance;
    self.implicit_options_.body_products = settings.body_products;
    self.longest_move_ = settings.longest_move;
    self.implicit_options_.weight = scene.world.gravity.norm();
    self.implicit_options_.sign_of_life = self.sign_of_life_;
  }
  for (const Record& r : self.particles_.record)
    self.facts_.max_speed = std::max(self.facts_.max_speed, static_cast<double>(std::hypot(r.vx, r.vy, r.vz)));
  self.facts_.meeting_speed = self.facts_.max_speed;
  self.facts_.max_acceleration = scene.world.gravity.norm();
  return fluid;
}

}  // namespace ballast::fluid
