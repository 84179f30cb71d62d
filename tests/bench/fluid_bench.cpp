// The fluid's step beside what the machine can do: a periodic box of water without bodies, its answer checked against
// brute force, conservation and the same bits for every number of threads. Yardsticks are measured between the steps.
#include <chrono>
#include <cmath>
#include <memory>

#include "fluid_server/step/wcsph.h"
#include "tests/bench/output.h"
#include "tests/bench/yardsticks.h"

namespace {

using namespace ballast;
using namespace ballast::fluid;
using bench::Row;
using Clock = std::chrono::steady_clock;

constexpr double kSpacing = 0.01, kSoundSpeed = 10;
constexpr double kDt = 0.2 * kSpacing / kSoundSpeed;

// Flops per interaction of the two passes over pairs (passes/pairs-inl.h, cubic spline, 3-D, without viscosity),
// counted by hand, a fused multiply-add as two, root and quotient as one: distance and slope 22 each, continuity 22,
// acceleration 24.
constexpr double kFlops = 90;

/// A box of nx x ny x nz particles that turns about its vertical axis: on periodic faces the turning meets itself as a
/// shear layer, so that particles mix; momentum stays zero in sum, and none of it may appear.
Scene box_of_water(int nx, int ny, int nz) {
  Scene scene;
  scene.world.gravity = Vec3::Zero();
  scene.world.spacing = kSpacing;
  scene.world.periodic = {true, true, true};
  scene.world.domain = Box3{Vec3::Zero(), kSpacing * Vec3(nx, ny, nz)};
  scene.numerics.sound_speed = kSoundSpeed;
  scene.numerics.kernel = KernelKind::kCubic;
  Fluid water;
  water.fill.box = *scene.world.domain;
  water.angular_velocity = Vec3(0, 0, 0.05 * kSoundSpeed / scene.world.domain->max.norm());
  scene.fluids.push_back(water);
  return scene;
}

struct Case {
  int nx, ny, nz, threads, steps;  // steps per repetition
  std::unique_ptr<WcsphFluid> fluid;
  std::vector<double> rate, fma, triad;  // per repetition: particle-steps/s, GFlop/s, GB/s
  double neighbours = 0, drift = 0;
  bool checked = true;
  std::size_t particles() const { return static_cast<std::size_t>(nx) * ny * nz; }
};

void advance(WcsphFluid& fluid, int steps) {
  for (int i = 0; i < steps; ++i) {
    fluid.begin({}, kDt);
    fluid.move();
  }
}

/// Everything about one particle that brute force needs.
struct Point {
  Fixed3 at;
  Vec3 velocity;
  double pressure;
};

std::vector<Point> points_by_id(const WcsphFluid& fluid) {
  std::vector<Point> out(fluid.particles().size());
  for (std::size_t f = 0; f < out.size(); ++f) {
    const Record& r = fluid.particles().record[f];
    out[fluid.particles().id[f]] = {{r.x, r.y, r.z}, {r.vx, r.vy, r.vz}, r.p};
  }
  return out;
}

constexpr std::size_t kSampled = 25;

/// One more step: pressure of some particles against continuity and diffusion summed over all pairs in double.
bool pressure_is_right(WcsphFluid& fluid) {
  const std::vector<Point> before = points_by_id(fluid);
  const double volume = std::abs(fluid.particles().record[0].volume), c = kSoundSpeed, rho = 1000;
  const Kernel& kernel = fluid.constants().kernel;
  fluid.begin({}, kDt);
  std::vector<double> after(before.size());
  for (std::size_t f = 0; f < before.size(); ++f) after[fluid.particles().id[f]] = fluid.particles().record[f].p;
  double worst = 0, largest = 0;
  for (std::size_t k = 0; k < kSampled; ++k) {
    const Point& own = before[k * (before.size() - 1) / (kSampled - 1)];
    double divergence = 0, diffusion = 0;
    for (const Point& other : before) {
      const Vec3 r = fluid.coordinates().difference(own.at, other.at);
      if (r.norm() >= kernel.support || &own == &other) continue;
      const double vg = volume * kernel.slope_over_r(r.norm());
      divergence += vg * (own.velocity - other.velocity).dot(r);
      diffusion += vg * (other.pressure - own.pressure);
    }
    const double rate = rho * c * c * divergence - 2 * fluid.constants().diffusion * kernel.h() * c * diffusion;
    const double expected = own.pressure + kDt * rate;
    worst = std::max(worst, std::abs(expected - after[static_cast<std::size_t>(&own - before.data())]));
    largest = std::max(largest, std::abs(kDt * rate));
  }
  fluid.move();
  if (worst <= 2e-4 * largest + 1e-6 * rho * c * c * 0.01) return true;
  std::fprintf(stderr, "fluid_bench: pressure differs from brute force by %g Pa of %g Pa\n", worst, largest);
  return false;
}

/// Summed density of some particles through the lists against all pairs in double; the mean number of neighbours.
bool density_is_right(const WcsphFluid& fluid, double& neighbours) {
  const Kernel& kernel = fluid.constants().kernel;
  Neighbourhood items(fluid.coordinates(), kernel.support, 3, fluid.constants().threads);
  Particles sorted;
  std::vector<float> delta, gradient;
  items.set_static_samples({});
  items.rebuild(fluid.particles(), sorted, {}, 0);
  build_lists(items, fluid.constants());
  sum_density(items, fluid.constants(), delta, gradient);
  double count = 0;
  for (std::uint16_t n : items.lists.count) count += n;
  neighbours = count / static_cast<double>(sorted.size());
  for (std::size_t k = 0; k < kSampled; ++k) {
    const std::size_t own = k * (sorted.size() - 1) / (kSampled - 1);
    const Record& a = sorted.record[own];
    double sum = 0;
    for (const Record& b : sorted.record)
      sum += b.volume * kernel.value(fluid.coordinates().difference({a.x, a.y, a.z}, {b.x, b.y, b.z}).norm());
    if (std::abs(delta[own] - sum) <= 1e-5) continue;  // float sums of some thirty terms near 1 / 30
    std::fprintf(stderr, "fluid_bench: summed density %.7g, brute force %.7g\n", delta[own], sum);
    return false;
  }
  return true;
}

/// Momentum beside the sum of its magnitudes.
double relative_momentum(const WcsphFluid& fluid) {
  Vec3 sum = Vec3::Zero();
  double scale = 0;
  for (const Record& r : fluid.particles().record) {
    const Vec3 v(r.vx, r.vy, r.vz);
    sum += v;
    scale += v.norm();
  }
  return sum.norm() / scale;
}

void measure(Case& c) {
  c.fma.push_back(bench::fma_peak(c.threads));
  c.triad.push_back(bench::triad_bandwidth(c.threads));
  const auto start = Clock::now();
  advance(*c.fluid, c.steps);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  c.rate.push_back(static_cast<double>(c.particles()) * c.steps / seconds);
}

void check(Case& c) {
  c.checked = pressure_is_right(*c.fluid) & density_is_right(*c.fluid, c.neighbours);
  c.drift = relative_momentum(*c.fluid);
  if (c.drift > 1e-5 || c.fluid->lost() > 0) {  // pair forces are opposite up to the rounding of float sums
    std::fprintf(stderr, "fluid_bench: momentum %g of its magnitudes, %zu particles lost\n", c.drift,
                 static_cast<std::size_t>(c.fluid->lost()));
    c.checked = false;
  }
}

void add_rows(std::vector<Row>& rows, const Case& c) {
  const std::size_t n = c.particles();
  const double rate = bench::median(c.rate), fma = bench::median(c.fma), triad = bench::median(c.triad);
  const double bytes = static_cast<double>(c.fluid->memory()) / static_cast<double>(n);
  rows.push_back({"fluid: FMA peak", 0, c.threads, fma, "GFlop/s", "itself", 1, true});
  rows.push_back({"fluid: triad bandwidth", 0, c.threads, triad, "GB/s", "itself", 1, true});
  rows.push_back({"fluid: wcsph step", n, c.threads, rate, "particle-steps/s", "FMA peak, flops of all pairs",
                  rate * c.neighbours * kFlops * 1e-9 / fma, c.checked});
  rows.push_back({"fluid: wcsph step, all arrays once", n, c.threads, rate * bytes * 1e-9, "GB/s", "triad bandwidth",
                  rate * bytes * 1e-9 / triad, c.checked});
  rows.push_back(
      {"fluid: memory", n, c.threads, bytes, "bytes/particle", "record and id, 36 bytes", bytes / 36, c.checked});
  rows.push_back({"fluid: neighbours", n, c.threads, c.neighbours, "per particle", "itself", 1, c.checked});
}

}  // namespace

int main(int argc, char** argv) {
  bench::let_idle_threads_sleep();
  bench::Options options;
  if (!options.parse(argc, argv, 7)) return kBadInput;
  Case cases[] = {{50, 50, 40, 1, 8, {}, {}, {}, {}},
                  {50, 50, 40, 2, 12, {}, {}, {}, {}},
                  {25, 20, 40, 1, 40, {}, {}, {}, {}},
                  {25, 20, 40, 2, 60, {}, {}, {}, {}}};
  for (Case& c : cases) {
    auto made = WcsphFluid::make(box_of_water(c.nx, c.ny, c.nz), {}, c.threads);
    if (!made) {
      std::fprintf(stderr, "fluid_bench: %s\n", made.error().text().c_str());
      return kProcessFailed;
    }
    c.fluid = *std::move(made);
    if (c.fluid->particles().size() != c.particles())
      return std::fprintf(stderr, "fluid_bench: wrong fill\n"), kProcessFailed;
    advance(*c.fluid, 200);  // 200 steps of warming up: the lattice is gone where it shears
  }
  for (std::size_t k = 0; k + 1 < std::size(cases); k += 2)
    cases[k].checked = cases[k + 1].checked = cases[k].fluid->hash() == cases[k + 1].fluid->hash();
  for (int r = 0; r < options.repetitions; ++r)
    for (Case& c : cases) measure(c);
  std::vector<Row> rows;
  for (Case& c : cases) {
    const bool same_bits = c.checked;
    check(c);
    c.checked &= same_bits;
    if (!same_bits) std::fprintf(stderr, "fluid_bench: one and two threads differ\n");
    add_rows(rows, c);
  }
  return bench::finish(options, rows, simd_name());
}
