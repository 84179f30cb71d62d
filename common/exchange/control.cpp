// The coordinator's side: credit, stop, reports, and the state of the two processes.
#include <cmath>
#include <cstring>

#include "common/exchange/link_impl.h"

namespace ballast::exchange {
namespace {

/// Tells both processes that credit or the gate has changed.
void ring_credit(Segment::Impl& s) {
  Word& credit = s.header().credit;
  // relaxed load: we are its only writer. seq_cst store: first half of the poster's pair, see wake_if_sleeping();
  // as a release it also publishes `granted` to await_credit().
  credit.store(credit.load(std::memory_order_relaxed) + 1, std::memory_order_seq_cst);
  for (Role role : {Role::kFluid, Role::kRigid}) {
    if (s.takes_part(role)) wake_if_sleeping(credit, s.peer(role));
  }
}

void beat(Segment::Impl& s) {
  PeerLine& self = s.peer(Role::kCoordinator);
  // relaxed: see Waiter::beat()
  self.heartbeat.store(self.heartbeat.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

bool finished(const PeerLine& line) {
  // acquire: partner is the release in Link::finish()
  return line.state.load(std::memory_order_acquire) == static_cast<std::uint32_t>(Attendance::kFinished);
}

/// A frame's size must fit its kind, as README.md says.
bool good_size(const FrameHead& head) {
  switch (head.kind) {
    case FrameKind::kStep:
      return head.bytes == sizeof(StepReport);
    case FrameKind::kBodies:
    case FrameKind::kProbes:
      return head.bytes % 8 == 0;
    case FrameKind::kWarning:
      return true;
    case FrameKind::kFluid:
      return head.bytes == sizeof(FluidStatistics);
    case FrameKind::kContacts:
      return head.bytes % sizeof(Contact) == 0;
    case FrameKind::kParticles:
      return head.bytes >= sizeof(ParticleSetHead) &&
             (head.bytes - sizeof(ParticleSetHead)) % sizeof(ParticleSample) == 0;
    case FrameKind::kCheckpoint:
      return head.bytes == sizeof(CheckpointPart);
    case FrameKind::kCommand:
      return head.bytes >= sizeof(CommandResult);
  }
  return false;
}

Expected reporter(const Segment::Impl& s, Role role, std::uint64_t step) {
  return {role_name(role), s.peer(role).pid.load(std::memory_order_relaxed), step, 0};
}

}  // namespace

std::span<const double> Frame::values() const {
  return {reinterpret_cast<const double*>(payload.data()), payload.size() / sizeof(double)};
}
StepReport Frame::step_report() const {
  StepReport report{};
  if (payload.size() == sizeof report) std::memcpy(&report, payload.data(), sizeof report);
  return report;
}
FluidStatistics Frame::fluid() const {
  FluidStatistics out{};
  if (payload.size() == sizeof out) std::memcpy(&out, payload.data(), sizeof out);
  out.limit[sizeof out.limit - 1] = 0;  // the sender is not trusted to have ended its text
  return out;
}
CheckpointPart Frame::checkpoint() const {
  CheckpointPart out{};
  if (payload.size() == sizeof out) std::memcpy(&out, payload.data(), sizeof out);
  return out;
}
CommandResult Frame::command() const {
  CommandResult out{};
  if (payload.size() >= sizeof out) std::memcpy(&out, payload.data(), sizeof out);
  return out;
}
std::string Frame::reason() const {
  return payload.size() <= sizeof(CommandResult) ? std::string() : text().substr(sizeof(CommandResult));
}
std::vector<Contact> Frame::contacts() const {
  std::vector<Contact> out(payload.size() / sizeof(Contact));
  if (!out.empty()) std::memcpy(out.data(), payload.data(), out.size() * sizeof(Contact));
  return out;
}
ParticleSetHead Frame::particle_head() const {
  ParticleSetHead out{};
  if (payload.size() >= sizeof out) std::memcpy(&out, payload.data(), sizeof out);
  return out;
}
std::vector<ParticleSample> Frame::particles() const {
  constexpr std::size_t kHead = sizeof(ParticleSetHead);
  std::vector<ParticleSample> out(payload.size() < kHead ? 0 : (payload.size() - kHead) / sizeof(ParticleSample));
  if (!out.empty()) std::memcpy(out.data(), payload.data() + kHead, out.size() * sizeof(ParticleSample));
  return out;
}
std::string Frame::text() const { return {reinterpret_cast<const char*>(payload.data()), payload.size()}; }

Control::Control(Segment& segment) : segment_(segment) { beat(segment.impl()); }

void Control::grant(std::uint64_t step) {
  Segment::Impl& s = segment_.impl();
  beat(s);
  // release: partner is the acquire in try_begin()
  s.header().granted.store(step, std::memory_order_release);
  ring_credit(s);
}

bool Control::send(const Command& command) {
  Segment::Impl& s = segment_.impl();
  beat(s);
  Ring ring(s.header().commands, s.records<std::byte>(Part::kCommands));
  // A corrupt tail gives a huge number here and so no room.
  const std::uint64_t used = ring.used_by_writer(ring.load_tail());
  if (used + sizeof command > ring.capacity()) return false;
  ring.put(0, &command, sizeof command);
  ring.publish(sizeof command);  // nobody sleeps on it: it is looked at when a step begins
  return true;
}

void Control::stop() {
  Segment::Impl& s = segment_.impl();
  beat(s);
  // acq_rel: partners are the compare-and-swaps in try_begin(); from here on nobody raises the gate
  s.header().gate.fetch_or(kClosed, std::memory_order_acq_rel);
  ring_credit(s);
}

Status Control::drain(Role role, std::vector<Frame>& out) {
  Segment::Impl& s = segment_.impl();
  beat(s);
  if (!s.takes_part(role) || role == Role::kCoordinator) return ok();
  const bool fluid = role == Role::kFluid;
  Ring ring(fluid ? s.header().fluid_reports : s.header().rigid_reports,
            s.records<std::byte>(fluid ? Part::kFluidReports : Part::kRigidReports));
  std::uint32_t left = ring.readable();
  const auto bad = [&](const FrameHead& head, const char* field, std::uint64_t seen, const char* wanted) {
    return bad_field(reporter(s, role, head.step), field, std::to_string(seen), wanted);
  };
  if (left > ring.capacity()) return bad({}, "head of the report ring", left, "at most its capacity ahead of tail");
  while (left != 0) {
    Frame frame{};
    if (left < sizeof frame.head) return bad({}, "bytes in the report ring", left, "whole frames");
    ring.get(0, &frame.head, sizeof frame.head);
    if (!good_size(frame.head)) {
      const auto kind = static_cast<std::uint32_t>(frame.head.kind);
      return kind >= kFrameKinds ? bad(frame.head, "kind of a report", kind, "what README.md allows")
                                 : bad(frame.head, "bytes of a report", frame.head.bytes, "what README.md allows");
    }
    const std::uint64_t size = sizeof frame.head + (std::uint64_t{frame.head.bytes} + 7) / 8 * 8;
    if (size > left) return bad(frame.head, "bytes of a report", frame.head.bytes, "no more than were written");
    if (!std::isfinite(frame.head.time)) {
      return bad_field(reporter(s, role, frame.head.step), "time of a report", "not finite", "a finite number");
    }
    frame.payload.resize(frame.head.bytes);
    ring.get(sizeof frame.head, frame.payload.data(), frame.payload.size());
    ring.release_to_writer(static_cast<std::uint32_t>(size));
    left -= static_cast<std::uint32_t>(size);
    out.push_back(std::move(frame));
    if (left == 0) wake_if_sleeping(ring.tail(), s.peer(role));  // once: its writer wakes up to a roomy ring
  }
  return ok();
}

void Control::wait_for_news(std::chrono::milliseconds at_most) {
  using Clock = std::chrono::steady_clock;
  Segment::Impl& s = segment_.impl();
  const Word& news = s.header().news;
  PeerLine& self = s.peer(Role::kCoordinator);
  const auto end = Clock::now() + at_most;
  // seq_cst pair with wake_if_sleeping(), as in Waiter::sleep()
  self.sleeping.store(1, std::memory_order_seq_cst);
  const auto died = [&](Role role) { return state(role) == PeerState::kDead; };
  for (;;) {
    beat(s);
    const std::uint32_t now_seen = news.load(std::memory_order_seq_cst);
    const auto left = end - Clock::now();
    if (now_seen != s.news_seen || left <= Clock::duration::zero() || died(Role::kFluid) || died(Role::kRigid)) {
      s.news_seen = now_seen;
      break;
    }
    futex_wait(news, now_seen, std::min<std::chrono::nanoseconds>(left, s.slice));
  }
  // relaxed: see ~Waiter
  self.sleeping.store(0, std::memory_order_relaxed);
}

PeerState Control::state(Role role) const {
  const Segment::Impl& s = segment_.impl();
  const PeerLine& line = s.peer(role);
  // acquire: partner is claim()
  const std::uint32_t pid = line.pid.load(std::memory_order_acquire);
  if (pid == 0) return PeerState::kAbsent;
  if (finished(line)) return PeerState::kFinished;
  if (alive(pid, line.start_time.load(std::memory_order_relaxed))) return PeerState::kRunning;
  return finished(line) ? PeerState::kFinished : PeerState::kDead;  // it may have finished and gone in between
}

int Control::exit_code(Role role) const {
  const PeerLine& line = segment_.impl().peer(role);
  return finished(line) ? static_cast<std::int32_t>(line.exit_code.load(std::memory_order_relaxed)) : kProcessFailed;
}

std::string Control::final_report(Role role) const {
  const Segment::Impl& s = segment_.impl();
  const PeerLine& line = s.peer(role);
  if (!finished(line)) return {};
  const auto text = s.records<char>(role == Role::kFluid ? Part::kFluidFinal : Part::kRigidFinal);
  const std::uint64_t bytes = line.final_bytes.load(std::memory_order_relaxed);
  return bytes <= text.size() ? std::string(text.data(), bytes) : std::string();
}

std::uint64_t Control::heartbeat(Role role) const {
  return segment_.impl().peer(role).heartbeat.load(std::memory_order_relaxed);
}

int Control::pid(Role role) const {
  return static_cast<int>(segment_.impl().peer(role).pid.load(std::memory_order_relaxed));
}

}  // namespace ballast::exchange
