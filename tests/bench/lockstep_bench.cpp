// What two processes cost: the same fluid and rigid work in one process and in two in lockstep, in turns, both cores
// busy. Checked: the same bits of all particles and bodies at the end.
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>

#include "common/exchange/hash.h"
#include "common/exchange/link.h"
#include "common/scene/reader.h"
#include "fluid_server/step/wcsph.h"
#include "rigid_client/engine.h"
#include "tests/bench/output.h"

namespace {

using namespace ballast;
using namespace ballast::exchange;
using Clock = std::chrono::steady_clock;

constexpr int kSteps = 300, kThreads = 2;
constexpr double kDt = 2.5e-4;  // s, below the acoustic limit of the scene

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// s; the same clock in all processes.
double now() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

/// The founding scene with the front just before the blocks, so that they are wet within the steps measured.
Result<Scene> make_scene() {
  return read_scene(BALLAST_SOURCE_DIR "/scenes/stacked_blocks.yaml", {{"fluids.water.fill.box.max", "[1, 0.6, 0.36]"},
                                                                       {"fluids.water.velocity", "[1, 0, 0]"},
                                                                       {"numerics.pressure", "wcsph"}});
}

struct Setting {
  Scene scene;
  std::vector<Body> bodies;
  Manifest manifest;
};

/// What a child leaves for its parent.
struct Outcome {
  std::atomic<bool> good;
  double seconds;  // of all steps
  std::uint64_t fluid_hash, bodies_hash;
  double waiting[kSteps];   // s, sending the order and receiving the answer, the engine's work included
  double exchange[kSteps];  // s, the same without it: sending, and receiving from when the answer was there
  std::atomic<double> answered[kSteps];  // s on the steady clock, when the engine was done
  double impulse;                        // N s, sum of magnitudes given to the bodies
  std::size_t particles;
};

std::vector<BodyState> first_states(const Setting& s) {
  std::vector<BodyState> states;
  for (std::size_t b = 0; b < s.bodies.size(); ++b)
    states.push_back(fluid::initial_state(s.scene.models[b], s.bodies[b], s.scene.world.gravity));
  return states;
}

void book(std::span<const Wrench> wrenches, Outcome& out) {
  for (std::size_t b = 1; b < wrenches.size(); ++b)  // 0 is the tank
    out.impulse += kDt * Eigen::Map<const Vec3>(wrenches[b].force).norm();
}

/// The rigid half of a step, as the rigid process does it.
bool engine_step(Engine& engine, std::vector<std::byte>& saved, std::span<const Wrench> wrenches, int step,
                 std::vector<BodyState>& states) {
  engine.save(saved);
  engine.apply(wrenches);
  if (!engine.step((step - 1) * kDt, kDt)) return false;
  engine.read(states);
  engine.mobility(states);
  return true;
}

bool one_process(const Setting& s, Outcome& out) {
  auto water = fluid::WcsphFluid::make(s.scene, s.bodies, kThreads);
  auto engine = make_engine(s.scene.coupling.engine);
  if (!water || !engine || !(*engine)->load(s.manifest.view())) return false;
  std::vector<BodyState> states(s.bodies.size());
  std::vector<std::byte> saved;
  (*engine)->read(states);
  (*engine)->mobility(states);
  const auto start = Clock::now();
  for (int step = 1; step <= kSteps; ++step) {
    (*water)->begin(states, kDt);
    const std::vector<Wrench> wrenches((*water)->wrenches().begin(), (*water)->wrenches().end());
    book(wrenches, out);
    if (!engine_step(**engine, saved, wrenches, step, states)) return false;
    (*water)->move();
  }
  out.seconds = seconds_since(start);
  out.fluid_hash = (*water)->hash();
  out.bodies_hash = state_hash(states);
  out.particles = (*water)->particles().size();
  return true;
}

bool fluid_process(const Setting& s, const std::string& name, Outcome& out) {
  auto segment = Segment::attach(name, Role::kFluid);
  auto water = fluid::WcsphFluid::make(s.scene, s.bodies, kThreads);
  if (!segment || !water) return false;
  FluidLink link(*segment);
  std::vector<BodyState> states = first_states(s);
  if (!link.receive(0, 0, states)) return false;
  const auto start = Clock::now();
  for (int step = 1; step <= kSteps; ++step) {
    (*water)->begin(states, kDt);
    book((*water)->wrenches(), out);
    Order order{};
    order.step = static_cast<std::uint64_t>(step);
    order.flags = step == kSteps ? kLast : 0u;
    order.time = (step - 1) * kDt;
    order.dt = order.next_dt = kDt;
    auto mark = Clock::now();
    if (!link.send(order, (*water)->wrenches(), (*water)->contacts())) return false;
    const double sending = seconds_since(mark);
    (*water)->move();
    const double asked = now();
    if (!link.receive(order.step, 0, states)) return false;
    const double received = now();
    // relaxed: the link has ordered it before the answer
    const double answered = out.answered[step - 1].load(std::memory_order_relaxed);
    out.waiting[step - 1] = sending + received - asked;
    out.exchange[step - 1] = sending + received - std::max(asked, answered);
  }
  out.seconds = seconds_since(start);
  out.fluid_hash = (*water)->hash();
  out.bodies_hash = state_hash(states);
  out.particles = (*water)->particles().size();
  return static_cast<bool>(link.finish(kFine, ""));
}

bool rigid_process(const Setting& s, const std::string& name, Outcome& out) {
  auto segment = Segment::attach(name, Role::kRigid);
  auto engine = make_engine(s.scene.coupling.engine);
  if (!segment || !engine || !(*engine)->load(segment->manifest())) return false;
  RigidLink link(*segment);
  std::vector<BodyState> states(s.bodies.size());
  std::vector<Wrench> wrenches(s.bodies.size());
  std::vector<Contact> contacts;
  std::vector<std::byte> saved;
  (*engine)->read(states);
  (*engine)->mobility(states);
  for (Answer answer{};;) {
    if (!link.send(answer, states)) return false;
    if (answer.step == kSteps) return static_cast<bool>(link.finish(kFine, ""));
    auto order = link.receive(wrenches, contacts);
    if (!order || !engine_step(**engine, saved, wrenches, static_cast<int>(order->step), states)) return false;
    answer.step = order->step;
    answer.time = order->time + order->dt;
    answer.hash = state_hash(states);
    out.answered[order->step - 1].store(now(), std::memory_order_relaxed);
  }
}

/// Everything runs in children: a process that has forked after its thread pool began could not use it again.
pid_t start(const std::function<bool()>& work) {
  std::fflush(nullptr);
  const pid_t pid = fork();
  if (pid != 0) return pid;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  _exit(work() ? 0 : 1);
}
bool ended_well(pid_t pid) {
  int status = 0;
  return waitpid(pid, &status, 0) == pid && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

bool run_in_one(const Setting& s, Outcome& out) {
  return ended_well(start([&] { return one_process(s, out); }));
}

bool run_in_two(const Setting& s, Outcome& out) {
  SegmentPlan plan;
  plan.manifest = s.manifest;
  plan.threads = kThreads;
  auto segment = Segment::create(Segment::make_name(), plan);
  if (!segment) return std::fprintf(stderr, "lockstep_bench: %s\n", segment.error().text().c_str()), false;
  const pid_t rigid = start([&] { return rigid_process(s, segment->name(), out); });
  const pid_t water = start([&] { return fluid_process(s, segment->name(), out); });
  return ended_well(water) & ended_well(rigid);
}

/// Outcomes live in memory that parent and children share.
Outcome* shared_outcomes(std::size_t count) {
  void* memory = mmap(nullptr, count * sizeof(Outcome), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  return memory == MAP_FAILED ? nullptr : static_cast<Outcome*>(memory);
}

bool same(const Outcome& a, const Outcome& b) {
  if (a.fluid_hash == b.fluid_hash && a.bodies_hash == b.bodies_hash && a.impulse > 0) return true;
  std::fprintf(stderr, "lockstep_bench: particles %016lx and %016lx, bodies %016lx and %016lx, impulse %g N s\n",
               a.fluid_hash, b.fluid_hash, a.bodies_hash, b.bodies_hash, a.impulse);
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  bench::let_idle_threads_sleep();
  bench::Options options;
  if (!options.parse(argc, argv, 5)) return kBadInput;
  auto scene = make_scene();
  if (!scene) return std::fprintf(stderr, "lockstep_bench: %s\n", scene.error().text().c_str()), kBadInput;
  auto bodies = make_bodies(*scene);
  if (!bodies) return std::fprintf(stderr, "lockstep_bench: %s\n", bodies.error().text().c_str()), kBadInput;
  Setting setting{*scene, *std::move(bodies), {}};
  setting.manifest = make_manifest(setting.scene, setting.bodies);
  const auto n = static_cast<std::size_t>(options.repetitions);
  Outcome* outcomes = shared_outcomes(2 * n);
  if (!outcomes) return kProcessFailed;
  std::vector<double> one, two, ratio, waiting, exchange;
  bool good = true;
  for (std::size_t r = 0; r < n && good; ++r) {
    Outcome &alone = outcomes[2 * r], &pair = outcomes[2 * r + 1];
    good = run_in_one(setting, alone) && run_in_two(setting, pair) && same(alone, pair) && same(outcomes[0], pair);
    one.push_back(alone.seconds / kSteps * 1e3);
    two.push_back(pair.seconds / kSteps * 1e3);
    ratio.push_back(pair.seconds / alone.seconds);
    waiting.insert(waiting.end(), pair.waiting, pair.waiting + kSteps);
    exchange.insert(exchange.end(), pair.exchange, pair.exchange + kSteps);
  }
  const std::size_t particles = outcomes[0].particles;
  const double step = bench::median(two);
  std::vector<bench::Row> rows{
      {"lockstep: step in one process", particles, kThreads, bench::median(one), "ms", "itself", 1, good},
      {"lockstep: step in two processes", particles, kThreads, step, "ms", "step in one process", bench::median(ratio),
       good},
      {"lockstep: exchange, without the engine's work", particles, kThreads, bench::median(exchange) * 1e6, "us",
       "step in two processes", bench::median(exchange) * 1e3 / step, good},
      {"lockstep: waiting, the engine's work included", particles, kThreads, bench::median(waiting) * 1e6, "us",
       "step in two processes", bench::median(waiting) * 1e3 / step, good}};
  return bench::finish(options, rows, "none");
}
