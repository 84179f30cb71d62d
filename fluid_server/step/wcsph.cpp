// One step of the weakly compressible fluid.
#include "fluid_server/step/wcsph.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/adding_watch.h"
#include "common/exchange/hash.h"
#include "fluid_server/pressure/sums.h"
#include "fluid_server/step/larger_than.h"
#include "fluid_server/step/meeting_speed.h"

namespace ballast::fluid {

namespace {

/// Position after a move of v dt; false if it left the domain along an axis that is not periodic.
bool advance(std::uint32_t& x, double move, double quantum, bool periodic) {
  const std::int64_t to = static_cast<std::int64_t>(x) + static_cast<std::int64_t>(std::llround(move / quantum));
  x = static_cast<std::uint32_t>(to);
  return periodic || (to >= 0 && to <= 0xffffffffLL);
}

}  // namespace

void WcsphFluid::begin(std::span<const exchange::BodyState> states, double dt, bool may_repeat) {
  constants_.dt = static_cast<float>(dt);
  facts_before_ = facts_;
  lost_before_ = lost_, energy_lost_before_ = energy_lost_;
  std::swap(particles_, before_);
  const double searching_since = times_.sort + times_.pressure;
  {
    const AddingWatch watch(times_.sort);
    samples_->place(states, coordinates_, constants_.threads);
    items_->rebuild(before_, particles_, samples_->moving(), samples_->first_moving);
    idle_.samples += samples_->size() - items_->sample_item.size(), ++idle_.steps;
    prepare_extras();
  }
  sign_of_life_();
  remember(may_repeat);
  const bool order_kept = items_->lists.valid;
  if (implicit_) {
    const AddingWatch watch(times_.pressure);
    build_lists(*items_, constants_);
  } else {
    const AddingWatch watch(times_.pressure);
    build_lists_and_advance_pressure(*items_, extras_, constants_, pressure_);
#pragma omp parallel for num_threads(constants_.threads) schedule(static)
    for (std::size_t f = 0; f < particles_.size(); ++f)
      particles_.record[f].p = items_->record[items_->fluid_item[f]].p = pressure_[f];
  }
  if (constants_.viscous) {
    const AddingWatch watch(times_.motion);
    find_evening(*items_, constants_, extras_.evening);
  }
  sign_of_life_();
  items_->searches.add(order_kept, times_.sort + times_.pressure - searching_since);
  if (constants_.ram_on_samples) {
    const AddingWatch watch(times_.boundary);
    response_->place_normals(*items_, states, extras_);
  }
  respond(states);
  const AddingWatch watch(times_.boundary);
  constexpr double kMayMatter = 0.01;  // of the fluid's own bound: bodies far lighter than a spacing of fluid are rare
  if (constants_.viscous && dt > kMayMatter * viscous_step(constants_.kernel.h(), kinematic_viscosity_))
    facts_.drag_rate = response_->drag_rate(*items_, sums_, states);
}

void WcsphFluid::again(std::span<const exchange::BodyState> states) {
  put_back();
  if (implicit_) particles_.compression = compression_before_;
  respond(states);
}

/// What a step changes beside particles and facts.
void WcsphFluid::remember(bool may_repeat) {
  if (const Seepage* films = response_->films())
    films_before_.assign(films->wrenches().begin(), films->wrenches().end());
  barrier_before_ = barrier_->report();
  if (shifting_) shift_before_ = shifting_->report();
  if (may_repeat && implicit_) compression_before_ = particles_.compression;
}

void WcsphFluid::put_back() {
  if (Seepage* films = response_->films()) films->put_back(films_before_);
  barrier_->put_back(barrier_before_);
  if (shifting_) shifting_->put_back(shift_before_);
}

/// Pressure as far as it hangs on the bodies' accelerations, and the wrenches.
void WcsphFluid::respond(std::span<const exchange::BodyState> states) {
  if (implicit_) {
    const AddingWatch watch(times_.pressure);
    implicit_options_.way = facts_.way;
    implicit_options_.tolerance = tolerance_ * share_of_tolerance();
    implicit_->solve(particles_, *items_, extras_, constants_, states, *response_, sums_, acceleration_,
                     implicit_options_);
  }
  const AddingWatch watch(times_.boundary);
  gather_samples(*items_, extras_, constants_, sums_);
  if (implicit_) implicit_->scale(sums_);
  response_->solve(*items_, extras_, sums_, constants_, states, implicit_ ? Scheme::kLeftOut : scheme_, Films::kFollow);
  barrier_->solve(*items_, extras_, sums_, constants_, states, *response_);
  if (contacts_every_step_) contacts_ = response_->gather_contacts(states);
}

/// In the shorter steps of deep water that hardly moves, the same error of the density is one of a larger pressure.
double WcsphFluid::share_of_tolerance() const {
  const double longest = pressure_step(facts_.lattice_rate);
  if (!(longest < gravity_step_) || facts_.meeting_speed * longest > longest_move_ * spacing_) return 1;
  return std::pow(longest / gravity_step_, 2);
}

void WcsphFluid::prepare_extras() {
  if (constants_.several_densities) {
    extras_.density.assign(items_->size() + Neighbourhood::kTail, filled_.fluids[0].density);
    for (std::size_t f = 0; f < particles_.size(); ++f)
      extras_.density[items_->fluid_item[f]] = fluid_of(particles_.id[f]).density;
  }
  if (constants_.viscous) {
    extras_.viscous.resize(items_->size());
#pragma omp parallel for num_threads(constants_.threads) schedule(static)
    for (std::size_t f = 0; f < particles_.size(); ++f) {
      const Record& r = particles_.record[f];
      extras_.viscous[items_->fluid_item[f]] = {r.vx, r.vy, r.vz, fluid_of(particles_.id[f]).viscosity};
    }
  }
}

void WcsphFluid::move(const std::function<void()>& first) {
  sign_of_life_();
  {
    const AddingWatch watch(times_.motion);
    accelerate(*items_, extras_, constants_, acceleration_, first);
    for (const Barrier::Push& push : barrier_->pushes())
      Eigen::Vector3f::Map(&acceleration_[3 * push.particle]) += push.gain / constants_.dt;
    if (attraction_rate_ > 0) attract();
    if (shifting_) shifting_->find(*items_, extras_, constants_);
    const double dt = constants_.dt;
    const float stiffness = constants_.sound_speed * constants_.sound_speed;
    double speed2 = 0, acceleration2 = 0, check = 0;
    std::uint64_t left = 0;
#pragma omp parallel for num_threads(constants_.threads) schedule(static) reduction(max : speed2, acceleration2) \
    reduction(+ : left, check)
    for (std::size_t f = 0; f < particles_.size(); ++f) {
      Record& r = particles_.record[f];
      const float* a = &acceleration_[3 * f];
      r.vx += constants_.dt * a[0];
      r.vy += constants_.dt * a[1];
      r.vz += constants_.dt * a[2];
      Vec3 way(r.vx * dt, r.vy * dt, r.vz * dt);
      if (shifting_) {
        way += shifting_->move(f).cast<double>();
        // the implicit solver's compression is pulled to the summed density anyway
        if (!implicit_) r.p -= stiffness * extras_.density_of(items_->fluid_item[f]) * shifting_->expansion();
      }
      bool inside = advance(r.x, way[0], coordinates_.quantum[0], coordinates_.periodic[0]);
      inside &= advance(r.y, way[1], coordinates_.quantum[1], coordinates_.periodic[1]);
      inside &= advance(r.z, way[2], coordinates_.quantum[2], coordinates_.periodic[2]);
      if (!inside) r.volume = 0, ++left;
      const double v2 =
          static_cast<double>(r.vx) * r.vx + static_cast<double>(r.vy) * r.vy + static_cast<double>(r.vz) * r.vz;
      const double a2 =
          static_cast<double>(a[0]) * a[0] + static_cast<double>(a[1]) * a[1] + static_cast<double>(a[2]) * a[2];
      speed2 = std::max(speed2, v2);
      acceleration2 = std::max(acceleration2, a2);
      check += (v2 + std::abs(r.p)) * 0;  // NaN if anything is not finite
    }
    facts_.max_speed = facts_.meeting_speed = std::sqrt(speed2);
    facts_.max_acceleration = std::sqrt(acceleration2);
    facts_.finite = check == 0;
    if (implicit_ && facts_.finite) {
      // In free flight up to half of the support, so that what comes into sight is never passed.
      const double alone = longest_move_ * spacing_ / (0.5 * constants_.kernel.support);
      facts_.meeting_speed = meeting_speed(particles_, *items_, alone, constants_.threads);
      facts_.lattice_rate = lattice_rate();
    }
    facts_.max_move = facts_.meeting_speed * dt / spacing_;
    facts_.way += facts_.max_move;
    for (const Record& r : samples_->moving()) {
      const double v = std::hypot(r.vx, r.vy, r.vz);
      facts_.max_speed = std::max(facts_.max_speed, v);
      facts_.meeting_speed = std::max(facts_.meeting_speed, v);
    }
    if (left) remove_lost();
  }
}

/// By the pressure that only a hundredth of the particles exceed: the few that an impact hits keep no lattice.
double WcsphFluid::lattice_rate() const {
  constexpr std::size_t kExceeded = 100;           // by one in so many
  std::vector<float> pressure(particles_.size());  // over the density
  for_blocks(particles_.size(), constants_.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const float p = particles_.record[f].p;  // -0 is no number >= 0 by its bits
      pressure[f] = p > 0 ? p / extras_.density_of(items_->fluid_item[f]) : 0.f;
    }
  });
  if (pressure.empty()) return 0;
  const double p = larger_than_all_but(pressure.size() / kExceeded, pressure, constants_.threads);
  return std::sqrt(lattice_stiffness_ * p) / spacing_;
}

void WcsphFluid::attract() {
#pragma omp parallel for num_threads(constants_.threads) schedule(static)
  for (std::size_t f = 0; f < particles_.size(); ++f)
    for (int k = 0; k < 3; ++k)
      acceleration_[3 * f + static_cast<std::size_t>(k)] -=
          static_cast<float>(attraction_rate_ * attraction_rate_ * from_centre(particles_.record[f])[k]);
}

Vec3 WcsphFluid::from_centre(const Record& r) const {
  Vec3 x = coordinates_.to_metres(r.x, r.y, r.z) - attraction_centre_;
  if (constants_.kernel.dimension == 2) x[1] = 0;
  return x;
}

void WcsphFluid::set_gravity(const Vec3& gravity) {
  for (int k = 0; k < 3; ++k) constants_.gravity[k] = static_cast<float>(gravity[k]);
  response_->set_gravity(gravity);
}

void WcsphFluid::roll_back() {
  std::swap(particles_, before_);
  facts_ = facts_before_;
  lost_ = lost_before_, energy_lost_ = energy_lost_before_;
  put_back();
}

/// Kinetic and potential energy of a particle that has just left, at its last place in the domain, J.
double WcsphFluid::energy_of_lost(std::size_t f) const {
  Record r = particles_.record[f];
  const auto back = [&](std::uint32_t& x, float v, double quantum) {
    x -= static_cast<std::uint32_t>(std::llround(v * static_cast<double>(constants_.dt) / quantum));
  };
  back(r.x, r.vx, coordinates_.quantum[0]);
  back(r.y, r.vy, coordinates_.quantum[1]);
  back(r.z, r.vz, coordinates_.quantum[2]);
  const FluidProperties& fluid = fluid_of(particles_.id[f]);
  const double mass = static_cast<double>(fluid.density) * fluid.volume;
  const Vec3 v(r.vx, r.vy, r.vz), gravity(constants_.gravity[0], constants_.gravity[1], constants_.gravity[2]);
  double energy = mass * (0.5 * v.squaredNorm() - gravity.dot(coordinates_.to_metres(r.x, r.y, r.z)));
  if (attraction_rate_ > 0) energy += 0.5 * mass * attraction_rate_ * attraction_rate_ * from_centre(r).squaredNorm();
  return energy;
}

void WcsphFluid::remove_lost() {
  std::size_t kept = 0;
  for (std::size_t f = 0; f < particles_.size(); ++f) {
    const Record& r = particles_.record[f];
    if (r.volume == 0) {
      ++lost_;
      energy_lost_ += energy_of_lost(f);
      lost_where_ = fmt::format("particle {} left the domain with velocity ({:.3g}, {:.3g}, {:.3g}) m/s",
                                particles_.id[f], r.vx, r.vy, r.vz);
      continue;
    }
    particles_.for_each_field([&](auto field) { (particles_.*field)[kept] = (particles_.*field)[f]; });
    ++kept;
  }
  particles_.resize(kept);
}

const FluidProperties& WcsphFluid::fluid_of(std::uint32_t id) const {
  const FluidProperties* fluid = filled_.fluids.data();
  for (const FluidProperties& next : filled_.fluids)
    if (id >= next.first_id) fluid = &next;
  return *fluid;
}

double WcsphFluid::stiffness() const {
  if (implicit_) return 0;
  double mass = 0;
  for (std::size_t f = 0; f < particles_.size(); ++f)
    mass += static_cast<double>(fluid_of(particles_.id[f]).density) * particles_.record[f].volume;
  return mass * constants_.sound_speed * constants_.sound_speed;
}

Measures WcsphFluid::measure() const {
  const std::size_t blocks = (particles_.size() + kSumBlock - 1) / kSumBlock;
  std::vector<Measures> part(blocks);
  const Vec3 gravity(constants_.gravity[0], constants_.gravity[1], constants_.gravity[2]);
  const double c2 = static_cast<double>(constants_.sound_speed) * constants_.sound_speed;
#pragma omp parallel for num_threads(constants_.threads) schedule(static)
  for (std::size_t b = 0; b < blocks; ++b) {
    Measures& m = part[b];
    for (std::size_t f = b * kSumBlock; f < std::min(particles_.size(), (b + 1) * kSumBlock); ++f) {
      const Record& r = particles_.record[f];
      const double rho = fluid_of(particles_.id[f]).density, mass = rho * r.volume, stiffness = rho * c2;
      const Vec3 x = coordinates_.to_metres(r.x, r.y, r.z), v(r.vx, r.vy, r.vz);
      m.mass += mass;
      m.kinetic += 0.5 * mass * v.squaredNorm();
      m.potential -= mass * gravity.dot(x);
      if (attraction_rate_ > 0)
        m.potential += 0.5 * mass * attraction_rate_ * attraction_rate_ * from_centre(r).squaredNorm();
      if (!implicit_) m.elastic += 0.5 * r.volume * static_cast<double>(r.p) * r.p / stiffness;
      m.momentum += mass * v;
      m.angular_momentum += mass * x.cross(v);
      if (implicit_) continue;
      const double e = std::abs(r.p) / stiffness;
      m.compression_mean += e;
      m.compression_max = std::max(m.compression_max, e);
    }
  }
  Measures total;
  for (const Measures& m : part) {
    total.mass += m.mass;
    total.kinetic += m.kinetic;
    total.potential += m.potential;
    total.elastic += m.elastic;
    total.momentum += m.momentum;
    total.angular_momentum += m.angular_momentum;
    total.compression_mean += m.compression_mean;
    total.compression_max = std::max(total.compression_max, m.compression_max);
  }
  if (particles_.size()) total.compression_mean /= static_cast<double>(particles_.size());
  if (implicit_)
    total.compression_mean = implicit_->report().found_mean, total.compression_max = implicit_->report().found_max;
  return total;
}

std::uint64_t WcsphFluid::hash() const {
  // particles_ may be sorted or not: order by id
  std::vector<std::uint32_t> at(particles_.size());
  for (std::uint32_t f = 0; f < at.size(); ++f) at[f] = f;
  std::sort(at.begin(), at.end(), [&](auto a, auto b) { return particles_.id[a] < particles_.id[b]; });
  exchange::Hash hash;
  for (std::uint32_t f : at) {
    hash.add(&particles_.id[f], sizeof(std::uint32_t));
    hash.add(&particles_.record[f], sizeof(Record));
  }
  return hash.value();
}

}  // namespace ballast::fluid
