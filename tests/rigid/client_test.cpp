// The rigid process from end to end: alone, in lockstep with a scripted fluid, with steps taken back, and with bad
// input.
#include "rigid_client/client.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "common/exchange/hash.h"
#include "rigid_client/client_report.h"
#include "tests/support/rigid_fixture.h"

namespace ballast::testing {

using exchange::Control;
using exchange::Frame;
using exchange::FrameKind;
using exchange::Role;
using exchange::Segment;
using nlohmann::json;

/// A segment with the rigid client attached to it in a thread; collects what it reports.
class Session {
 public:
  Session(const World& world, bool fluid, const std::string& engine = "ode")
      : segment_(create(world, fluid)), control_(segment_) {
    control_.grant(1'000'000);
    client_ = std::thread([this, engine] {
      auto own = Segment::attach(name_, Role::kRigid);
      outcome_ = own ? rigid::serve(*own, engine) : Status(own.error());
    });
  }
  ~Session() {
    if (client_.joinable()) client_.join();
  }

  /// Waits for the client's end and reads everything that it sent.
  void end() {
    client_.join();
    std::vector<Frame> frames;
    EXPECT_TRUE(control_.drain(Role::kRigid, frames));
    for (const Frame& f : frames) {
      if (f.head.kind == FrameKind::kStep) steps.push_back(f.step_report());
      if (f.head.kind == FrameKind::kBodies) {
        times.push_back(f.head.time);
        rows.emplace_back(f.values().begin(), f.values().end());
      }
    }
    report = json::parse(control_.final_report(Role::kRigid));
    exit_code = control_.exit_code(Role::kRigid);
  }

  const std::string& name() const { return name_; }
  Control& control() { return control_; }

  std::vector<exchange::StepReport> steps;
  std::vector<double> times;
  std::vector<std::vector<double>> rows;
  json report;
  int exit_code = -1;

 private:
  Segment create(const World& world, bool fluid) {
    name_ = Segment::make_name();
    exchange::SegmentPlan plan;
    plan.manifest = world.manifest;
    plan.fluid = fluid;
    plan.out_dir = "/tmp";
    auto made = Segment::create(name_, plan);
    if (!made) throw std::runtime_error(made.error().text());
    return *std::move(made);
  }

  std::string name_;
  Segment segment_;
  Control control_;
  Status outcome_ = ok();
  std::thread client_;
};

/// A box on a floor and a ball that falls beside it.
World small_world() {
  World world;
  world.manifest.world.duration = 0.1;
  world.manifest.world.output_every = 0.02;
  world.plane({0, 0, 1});
  world.box(BodyMotion::kDynamic, 2, {0.1, 0.1, 0.1}, {0, 0, 0.05});
  world.sphere(1, 0.05, {0.3, 0, 0.07}, 0.3, 0.5);
  return world;
}

// S39: bodies only, bit for bit as the engine by itself.
TEST(Client, AloneItRunsTheEngineToTheEnd) {
  const World world = small_world();
  Session session(world, false);
  session.end();
  Simulation alone("ode", world, 1e-3);
  for (int i = 0; i < 100; ++i) alone.step();
  EXPECT_EQ(session.exit_code, kFine) << session.report.dump();
  ASSERT_EQ(session.steps.size(), 100u);
  EXPECT_EQ(session.steps.back().hash, exchange::state_hash(alone.states));
  EXPECT_DOUBLE_EQ(session.steps.back().time, 0.1);
  EXPECT_EQ(session.report["steps"], 100);
  ASSERT_EQ(session.rows.size(), 6u) << "t = 0, then every 20 ms, the end once";
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(session.times[i], 0.02 * static_cast<double>(i), 1e-12);
  ASSERT_EQ(session.rows[5].size(), 2u * 22u) << "the static floor has no columns";
  EXPECT_EQ(session.rows[5][22 + 2], alone.position(2).z());
  EXPECT_EQ(session.rows[0][3], 1) << "qw";
}

TEST(Client, LastStepIsShortenedToTheDuration) {
  World world = small_world();
  world.manifest.world.duration = 0.0125;
  Session session(world, false);
  session.end();
  ASSERT_EQ(session.steps.size(), 13u);
  EXPECT_DOUBLE_EQ(session.steps.back().time, 0.0125);
  EXPECT_NEAR(session.steps.back().dt, 0.0005, 1e-12);
  EXPECT_DOUBLE_EQ(session.times.back(), 0.0125);
}

TEST(Client, StopEndsItBetweenTwoSteps) {
  World world = small_world();
  world.manifest.world.duration = 1e6;
  Session session(world, false);
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  session.control().stop();
  session.end();
  EXPECT_EQ(session.exit_code, kFine);
  EXPECT_EQ(session.report["steps"], session.steps.size());
}

/// Force of a scripted fluid on the bodies at a step: different for every body and step.
std::vector<Wrench> scripted_wrenches(std::uint64_t step) {
  std::vector<Wrench> wrenches(3, Wrench{});
  const double s = static_cast<double>(step);
  put(wrenches[1].force, {0.3 * s, 0.1, 20 + s});
  put(wrenches[2].force, {1 / s, 0, 7});
  put(wrenches[2].torque, {0, 1e-3 * s, 0});
  return wrenches;
}

/// The other side of the lockstep: `steps` steps, taking step `retry` back once with a wrench that must leave no trace.
std::vector<std::uint64_t> play_fluid(Session& session, std::uint64_t steps, std::uint64_t retry) {
  auto segment = Segment::attach(session.name(), Role::kFluid);
  if (!segment) throw std::runtime_error(segment.error().text());
  exchange::FluidLink link(*segment);
  std::vector<BodyState> states(3);
  std::vector<std::uint64_t> hashes;
  EXPECT_TRUE(link.receive(0, 0, states));
  for (std::uint64_t step = 1; step <= steps; ++step) {
    for (std::uint32_t iteration = 0; iteration < (step == retry ? 2u : 1u); ++iteration) {
      exchange::Order order{};
      order.step = step;
      order.iteration = iteration;
      order.flags = (iteration > 0 ? exchange::kRollBack : 0u) |
                    (step == steps ? static_cast<std::uint32_t>(exchange::kLast) : 0u);
      order.time = 1e-3 * static_cast<double>(step - 1);
      order.dt = 1e-3;
      std::vector<Wrench> wrenches = scripted_wrenches(step);
      if (step == retry && iteration == 0) put(wrenches[1].force, {500, 500, 500});
      exchange::Contact contact{};
      contact.body = 1;
      contact.normal[2] = 1;
      std::copy_n(wrenches[1].force, 3, contact.force);
      EXPECT_TRUE(link.send(order, wrenches, std::span(&contact, 1)));
      const auto answer = link.receive(step, iteration, states);
      EXPECT_TRUE(answer);
      if (!answer) return hashes;
      EXPECT_EQ(answer->hash, exchange::state_hash(states));
    }
    hashes.push_back(exchange::state_hash(states));
  }
  EXPECT_TRUE(link.finish(kFine, "{}"));
  return hashes;
}

TEST(Client, LockstepAppliesWrenchesAndKeepsTheLedger) {
  Session session(small_world(), true);
  const auto hashes = play_fluid(session, 50, 0);
  session.end();
  EXPECT_EQ(session.exit_code, kFine) << session.report.dump();
  ASSERT_EQ(session.steps.size(), 50u);
  Simulation alone("ode", small_world(), 1e-3);
  Vec impulse = Vec::Zero();
  for (std::uint64_t step = 1; step <= 50; ++step) {
    alone.wrenches = scripted_wrenches(step);
    alone.step();
    ASSERT_EQ(hashes[step - 1], exchange::state_hash(alone.states)) << "step " << step;
    EXPECT_EQ(session.steps[step - 1].hash, hashes[step - 1]);
    EXPECT_EQ(session.steps[step - 1].step, step);
    impulse += 1e-3 * (vec(alone.wrenches[1].force) + vec(alone.wrenches[2].force));
    EXPECT_NEAR((vec(session.steps[step - 1].impulse) - impulse).norm(), 0, 1e-12) << "step " << step;
  }
  const json ledger = session.report["ledger"];
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(ledger["momentum_received_N_s"][k].get<double>(), impulse[static_cast<int>(k)], 1e-12);
    EXPECT_EQ(session.steps.back().impulse[k], ledger["momentum_received_N_s"][k]) << "all along, in the step reports";
  }
  EXPECT_EQ(session.steps.back().impulse_scale, ledger["momentum_received_scale_N_s"]);
  EXPECT_NEAR(ledger["momentum_received_by_body_N_s"]["body2"][2].get<double>(), 50 * 7e-3, 1e-12);
  EXPECT_EQ(session.report["contact_sets"]["received"], 50);
  EXPECT_EQ(session.report["contact_sets"]["force_mismatch_max"], 0.0);
  EXPECT_NEAR(session.rows.back()[22 + 18], 7, 1e-12) << "force on the ball in the last row";
}

TEST(Client, StepTakenBackLeavesNoTrace) {
  for (const std::uint64_t retry : {1u, 20u, 50u}) {  // the last step may be taken back as well
    Session straight(small_world(), true);
    const auto a = play_fluid(straight, 50, 0);
    straight.end();
    Session retried(small_world(), true);
    const auto b = play_fluid(retried, 50, retry);
    retried.end();
    EXPECT_EQ(a, b) << "retry of step " << retry;
    EXPECT_EQ(straight.report["ledger"], retried.report["ledger"]);
    ASSERT_EQ(retried.steps.size(), 50u) << "a step taken back is not reported";
    EXPECT_EQ(retried.steps[retry - 1].iteration, 1u);
    EXPECT_EQ(retried.exit_code, kFine);
  }
}

TEST(Client, UnknownEngineAndBadManifestAreReported) {
  Session unknown(small_world(), false, "warp");
  unknown.end();
  EXPECT_EQ(unknown.exit_code, kBadInput);
  EXPECT_NE(unknown.report["error"].get<std::string>().find("warp"), std::string::npos);
  World world = small_world();
  world[1].mass = -2;
  Session bad(world, false);
  bad.end();
  EXPECT_EQ(bad.exit_code, kBadInput);
  EXPECT_NE(bad.report["error"].get<std::string>().find("mass is -2"), std::string::npos);
}

TEST(Client, DivergenceEndsWithItsCodeAndTheBodysName) {
  World world = small_world();
  put(world[2].velocity, {2e6, 0, 0});
  Session session(world, false);
  session.end();
  EXPECT_EQ(session.exit_code, kDiverged);
  EXPECT_NE(session.report["error"].get<std::string>().find("body2"), std::string::npos);
}

TEST(Client, ContactForcesAreComparedWithTheWrench) {
  std::vector<Wrench> wrenches(2, Wrench{});
  put(wrenches[0].force, {0, 0, 10});
  put(wrenches[1].force, {4, 0, 0});
  std::vector<exchange::Contact> contacts(3, exchange::Contact{});
  put(contacts[0].force, {0, 0, 4});
  put(contacts[1].force, {0, 0, 6});
  contacts[2].body = 1;
  put(contacts[2].force, {3, 0, 0});
  EXPECT_DOUBLE_EQ(rigid::force_mismatch(wrenches, contacts), 0.1) << "1 N of 10 N is missing on the second body";
  EXPECT_EQ(rigid::force_mismatch(wrenches, {}), 0);
}

}  // namespace ballast::testing
