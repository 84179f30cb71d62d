// One step of the weakly compressible fluid (delta-SPH: Antuono, Colagrossi and Marrone 2012), volumes fixed:
//   sort -> lists and pressure (continuity) -> samples and bodies -> [wrenches out] -> acceleration and motion.
// Pressure is the state, p = rho c^2 e with e the compression that continuity integrates. The force is the transpose of
// the divergence, so that the two exchange energy without making any.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/geometry/bodies.h"
#include "common/result.h"
#include "fluid_server/boundary/barrier.h"
#include "fluid_server/boundary/response.h"
#include "fluid_server/particles/fill.h"
#include "fluid_server/particles/relax.h"
#include "fluid_server/passes/passes.h"
#include "fluid_server/pressure/implicit.h"
#include "fluid_server/step/shifting.h"
#include "fluid_server/step/step_control.h"

namespace ballast::fluid {

/// Seconds spent, by stage.
struct StageTimes {
  double sort = 0, pressure = 0, boundary = 0, motion = 0;
};

/// Boundary samples that no particle was near of, summed over the steps: they cost nothing but their place.
struct IdleSamples {
  std::uint64_t samples = 0, steps = 0;
};

/// How the search for the starting pressure went.
struct QuietReport {
  int rounds = 0;     ///< 0: not done, something moves at the start (implicit: the fluid does)
  double change = 0;  ///< of pressure in the last round, over the largest pressure
};

/// Sums over all particles, in double and in a fixed order.
struct Measures {
  template <class A>
  void state(A& a) {
    a("kinetic", kinetic), a("potential", potential), a("elastic", elastic), a("momentum", momentum);
    a("angular_momentum", angular_momentum), a("mass", mass);
    a("compression_mean", compression_mean), a("compression_max", compression_max);
  }
  double kinetic = 0, potential = 0, elastic = 0;    ///< J
  Vec3 momentum = Vec3::Zero();                      ///< kg m/s
  Vec3 angular_momentum = Vec3::Zero();              ///< about the origin, kg m^2/s
  double mass = 0;                                   ///< kg
  double compression_mean = 0, compression_max = 0;  ///< |p| / (rho c^2); implicit: e that the last step began with
};

class WcsphFluid {
 public:
  /// `bodies` must outlive the fluid. Large scenes take minutes to set up: `sign_of_life` is called now and then, in
  /// quiet_start() too.
  /// `relax`: false where a checkpoint brings the particles. `threads`: 0 for as many as pay.
  static Result<std::unique_ptr<WcsphFluid>> make(
      const Scene& scene, const std::vector<Body>& bodies, int threads, std::function<void()> sign_of_life = [] {},
      bool relax = true);

  /// Finds the pressure with which nothing is compressed at the moment of release; for states at rest, before the first
  /// step. Costs some hundred sweeps where something gives way, one where all is in balance.
  QuietReport quiet_start(std::span<const exchange::BodyState> states);

  /// First half of a step of length dt: everything up to the wrenches on the bodies in `states`. `may_repeat`: again()
  /// may be called.
  void begin(std::span<const exchange::BodyState> states, double dt, bool may_repeat = false);
  /// The wrenches once more, for the same states with other free accelerations; between begin() and move(), and only
  /// with the iterated scheme. Nothing has moved: neighbours, lists and what hangs on velocities are as they were.
  void again(std::span<const exchange::BodyState> states);
  /// Second half: moves the particles. Afterwards limits() speaks of the new state. first(): sends the wrenches. One
  /// thread calls it while others are at work already, since whom it wakes may take that thread's core.
  void move(const std::function<void()>& first = {});
  /// Back to the state before begin(); wrenches are void.
  void roll_back();

  const StepFacts& facts() const { return facts_; }
  std::span<const exchange::Wrench> wrenches() const { return response_->wrenches(); }
  /// Where the fluid touches each body, for the engine; none where it does not want them with every step.
  std::span<const exchange::Contact> contacts() const { return contacts_; }
  /// The same for whoever shows them. `states`: those at the beginning of the last step that was computed.
  std::span<const exchange::Contact> gather_contacts(std::span<const exchange::BodyState> states) {
    return response_->gather_contacts(states);
  }

  Measures measure() const;
  const Particles& particles() const { return particles_; }
  const Coordinates& coordinates() const { return coordinates_; }
  const Samples& samples() const { return *samples_; }
  const PassConstants& constants() const { return constants_; }
  const Filled& filled() const { return filled_; }
  const RelaxReport& relax_report() const { return relax_report_; }
  const StageTimes& times() const { return times_; }
  const SearchCounts& searches() const { return items_->searches; }
  const IdleSamples& idle_samples() const { return idle_; }
  const FluidProperties& fluid_of(std::uint32_t id) const;
  double spacing() const { return spacing_; }
  std::uint64_t lost() const { return lost_; }
  double energy_lost() const { return energy_lost_; }  ///< kinetic and potential, of those that left the domain, J
  const std::string& lost_where() const { return lost_where_; }
  std::uint64_t hash() const;  ///< of all particles, in order of id
  Scheme scheme() const { return scheme_; }
  const ImplicitPressure* implicit() const { return implicit_.get(); }  ///< null: weakly compressible

  /// From the next step on, m/s^2.
  void set_gravity(const Vec3& gravity);

  /// All that later steps and the record depend on (common/checkpoint/state.h); between two steps.
  template <class A>
  void state(A& a) {
    a("particles", particles_);
    a("facts", facts_);
    a("lost", lost_), a("energy_lost", energy_lost_);
    a("lost_where", lost_where_);
    a("relaxed", relax_report_);
    a("response", *response_);
    a("barrier", *barrier_);
    if (implicit_) a("implicit", *implicit_);
    if (shifting_) a("shifting", *shifting_);
  }

  /// rho c^2 times volume, summed, J; 0 for an incompressible fluid.
  double stiffness() const;
  const BarrierReport& barrier() const { return barrier_->report(); }
  const ShiftReport* shifting() const { return shifting_ ? &shifting_->report() : nullptr; }
  std::size_t memory() const;  ///< bytes of all arrays that live through a step

 private:
  WcsphFluid() = default;
  void prepare_extras();
  void remember(bool may_repeat);
  void put_back();
  void respond(std::span<const exchange::BodyState> states);
  void put_accelerations_for_velocities();
  /// Adds the field of world.attraction to the accelerations.
  void attract();
  double lattice_rate() const;
  double share_of_tolerance() const;
  /// Way from the centre of that field to a particle, m.
  Vec3 from_centre(const Record& r) const;
  void remove_lost();
  double energy_of_lost(std::size_t f) const;

  Coordinates coordinates_;
  double spacing_ = 0;
  PassConstants constants_;
  Scheme scheme_ = Scheme::kInterlinked;
  Filled filled_;  // fluids and reports; its particles have moved to particles_
  RelaxReport relax_report_;
  Particles particles_, before_;  // now, and before begin()
  std::unique_ptr<Samples> samples_;
  std::unique_ptr<Neighbourhood> items_;
  std::unique_ptr<Response> response_;
  std::unique_ptr<Barrier> barrier_;
  ItemExtras extras_;
  double attraction_rate_ = 0;             // 1/s, of world.attraction
  Vec3 attraction_centre_ = Vec3::Zero();  // m
  std::vector<float> pressure_, acceleration_;
  std::vector<SampleSums> sums_;
  std::unique_ptr<ImplicitPressure> implicit_;  // null: the fluid is weakly compressible
  std::unique_ptr<Shifting> shifting_;          // null: particles go where their velocity takes them
  ImplicitOptions implicit_options_;
  // of the implicit solver
  double longest_move_ = 0;       // of a step, spacings
  double gravity_step_ = 0;       // s, 0 without gravity
  double tolerance_ = 0;          // mean density error left by a step of that length
  double lattice_stiffness_ = 0;  // kernel.h
  StepFacts facts_, facts_before_;
  bool contacts_every_step_ = false;  // they go to the engine
  std::span<const exchange::Contact> contacts_;
  std::vector<float> compression_before_;
  std::vector<exchange::Wrench> films_before_;
  BarrierReport barrier_before_;
  ShiftReport shift_before_;
  double kinematic_viscosity_ = 0;  // largest, m^2/s
  std::function<void()> sign_of_life_;
  StageTimes times_;
  IdleSamples idle_;
  std::uint64_t lost_ = 0, lost_before_ = 0;
  double energy_lost_ = 0, energy_lost_before_ = 0;
  std::string lost_where_;
};

/// The scene's, or that of its accuracy class and solver.
Kernel choose_kernel(const Scene& scene);

/// Longest step of an implicit fluid at rest under gravity, s: a share of sqrt(d / |G|) that the accuracy class sets.
double gravity_step(const Scene& scene);

/// Box that particles may be in: world.domain, or around everything in the scene with room above for splashes.
Box3 choose_domain(const Scene& scene, const std::vector<Body>& bodies, double support);

/// Ten times the largest speed expected: that of a fall through the fluid's whole height, or of what moves at the
/// start.
double choose_sound_speed(const Scene& scene, const std::vector<Body>& bodies, const Filled& filled);

}  // namespace ballast::fluid
