// What both physics processes do besides exchanging: credit, reports, end; and the posting of messages.
#include "common/exchange/link.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "common/exchange/link_impl.h"

namespace ballast::exchange {
namespace {

/// A frame's size in the ring: head, payload, zero bytes up to a multiple of 8.
std::size_t frame_bytes(std::size_t payload) { return sizeof(FrameHead) + (payload + 7) / 8 * 8; }

enum class Begin { kYes, kEnd, kNotYet };

/// Both processes end after the same step: whoever begins a step first raises the gate to it, stop() closes the gate,
/// and a closed gate lets through only steps that someone has begun. One word, so that begin and stop have one order.
Begin try_begin(Header& h, std::uint64_t step) {
  // acquire: partner is stop()'s fetch_or; acq_rel below: each sees what the other two did to this word before
  std::uint64_t gate = h.gate.load(std::memory_order_acquire);
  for (;;) {
    if (step <= (gate & ~kClosed)) return Begin::kYes;
    if (gate & kClosed) return Begin::kEnd;
    // acquire: partner is the release in grant()
    if (h.granted.load(std::memory_order_acquire) < step) return Begin::kNotYet;
    if (h.gate.compare_exchange_weak(gate, step, std::memory_order_acq_rel, std::memory_order_acquire)) {
      return Begin::kYes;
    }
  }
}

}  // namespace

Link::Waiting::Waiting(Segment::Impl& s, Role role) : segment(s), self(role), waiter(s, role) {
  Header& h = s.header();
  const bool fluid = role == Role::kFluid;
  reports = Ring(fluid ? h.fluid_reports : h.rigid_reports,
                 s.records<std::byte>(fluid ? Part::kFluidReports : Part::kRigidReports));
  contacts = Ring(h.contacts, s.records<std::byte>(Part::kContacts));
  if (s.block(Part::kCommands).bytes > 0) command_ring = Ring(h.commands, s.records<std::byte>(Part::kCommands));
  if (fluid) merged.resize(s.manifest.bodies.size());
  step = h.first_step;
}

void Link::Waiting::post(Mailbox& mailbox, Role reader) {
  ++posted;
  // release: partner is the reader's acquire in Waiter; the payload is visible to whoever sees this number.
  // seq_cst besides: first half of the poster's pair, see wake_if_sleeping().
  mailbox.sequence.store(posted, std::memory_order_seq_cst);
  wake_if_sleeping(mailbox.sequence, segment.peer(reader));
}

Result<Waiter::End> Link::Waiting::await_message(const Mailbox& mailbox, Role peer) {
  auto end = waiter.wait(mailbox.sequence, received, peer);
  if (!end || *end == Waiter::End::kPeerFinished) return end;
  // acquire: partner is post(); the payload is read after this
  const std::uint32_t sequence = mailbox.sequence.load(std::memory_order_acquire);
  if (sequence != received + 1) {
    return bad_field(expected(peer), "sequence", std::to_string(sequence), std::to_string(received + 1));
  }
  ++received;
  return end;
}

Expected Link::Waiting::expected(Role sender) const {
  return {role_name(sender), segment.peer(sender).pid.load(std::memory_order_relaxed), step, iteration};
}

void Link::Waiting::tell_coordinator() {
  Word& news = segment.header().news;
  // Two writers, hence a read-modify-write. seq_cst: first half of the poster's pair, see wake_if_sleeping().
  news.fetch_add(1, std::memory_order_seq_cst);
  wake_if_sleeping(news, segment.peer(Role::kCoordinator));
}

Status Link::Waiting::write_frame(const FrameHead& head, std::span<const std::byte> payload) {
  if (auto good = waiter.look_if_due(); !good) return good;
  const std::size_t size = frame_bytes(payload.size());
  if (size > reports.capacity()) {
    return Error{
        "a report of " + std::to_string(size) + " bytes does not fit the ring of " + std::to_string(reports.capacity()),
        "report fewer values at once, or plan a larger report ring", "", kProcessFailed};
  }
  const auto need = static_cast<std::uint32_t>(size);
  for (bool first = true;; first = false) {
    const std::uint32_t tail = reports.load_tail(), used = reports.used_by_writer(tail);
    if (used > reports.capacity()) {
      return bad_field(expected(Role::kCoordinator), "tail of the report ring", std::to_string(tail), "at most head");
    }
    if (reports.capacity() - used >= need) break;
    blocked += first;
    auto end = waiter.wait(reports.tail(), tail, Role::kCoordinator);
    if (!end) return end.error();
  }
  put_frame(head, payload);
  return ok();
}

void Link::Waiting::put_frame(const FrameHead& head, std::span<const std::byte> payload) {
  static constexpr std::byte kPadding[8] = {};
  const std::size_t size = frame_bytes(payload.size()), end = sizeof head + payload.size();
  reports.put(0, &head, sizeof head);
  reports.put(sizeof head, payload.data(), payload.size());
  reports.put(static_cast<std::uint32_t>(end), kPadding, size - end);
  reports.publish(static_cast<std::uint32_t>(size));
  tell_coordinator();
}

Link::Link(Segment& segment, Role self)
    : segment_(segment), self_(self), waiting_(std::make_unique<Waiting>(segment.impl(), self)) {}
Link::~Link() = default;

Result<bool> Link::await_credit(std::uint64_t step) {
  Waiting& w = *waiting_;
  if (auto good = w.waiter.look_if_due(); !good) return good.error();
  Header& h = w.segment.header();
  for (;;) {
    // acquire: partner is ring_credit() in control.cpp; read before granted and gate, so that a later change wakes us
    const std::uint32_t seen = h.credit.load(std::memory_order_acquire);
    const Begin begin = try_begin(h, step);
    if (begin == Begin::kEnd) return false;
    if (begin == Begin::kYes) {
      w.waiter.note_step(step);
      return true;
    }
    auto end = w.waiter.wait(h.credit, seen, Role::kCoordinator);
    if (!end) return end.error();
  }
}

Status Link::report(const StepReport& report) {
  const FrameHead head{FrameKind::kStep, sizeof report, report.step, report.time};
  return waiting_->write_frame(head, std::as_bytes(std::span(&report, 1)));
}

Status Link::frame(FrameKind kind, std::uint64_t step, double time, std::span<const double> values) {
  if (kind != FrameKind::kBodies && kind != FrameKind::kProbes) return misuse("frame(): only bodies and probes");
  const auto bytes = std::as_bytes(values);
  return waiting_->write_frame({kind, static_cast<std::uint32_t>(bytes.size()), step, time}, bytes);
}

Status Link::warning(std::uint64_t step, double time, std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text.data(), std::min<std::size_t>(text.size(), 2048)));
  return waiting_->write_frame({FrameKind::kWarning, static_cast<std::uint32_t>(bytes.size()), step, time}, bytes);
}

Result<std::vector<Command>> Link::commands(std::uint64_t step) {
  Waiting& w = *waiting_;
  std::vector<Command> due;
  if (w.command_ring.capacity() == 0) return due;
  const std::uint32_t bytes = w.command_ring.readable();
  if (bytes > w.command_ring.capacity() || bytes % sizeof(Command) != 0)
    return bad_field(w.expected(Role::kCoordinator), "bytes in the command ring", std::to_string(bytes),
                     "whole commands");
  for (std::uint32_t at = 0; at < bytes; at += sizeof(Command)) {
    w.command_ring.get(at, &w.commands.emplace_back(), sizeof(Command));
    if (auto good = check_command(w.commands.back(), w.expected(Role::kCoordinator), w.segment.manifest); !good)
      return good.error();
  }
  w.command_ring.release_to_writer(bytes);
  std::erase_if(w.commands, [&](const Command& c) {
    if (c.step > step || due.size() == kMostCommands) return false;
    due.push_back(c);
    return true;
  });
  return due;
}

Status Link::command_result(std::uint64_t step, double time, std::uint64_t id, std::string_view reason) {
  const std::string_view text = reason.substr(0, 2048);
  const CommandResult result{id, reason.empty() ? 0u : 1u, 0};
  std::vector<std::byte> payload(sizeof result + text.size());
  std::memcpy(payload.data(), &result, sizeof result);
  if (!text.empty()) std::memcpy(payload.data() + sizeof result, text.data(), text.size());
  return waiting_->write_frame({FrameKind::kCommand, static_cast<std::uint32_t>(payload.size()), step, time}, payload);
}

Status Link::checkpoint(std::uint64_t step, double time, const CheckpointPart& part) {
  return waiting_->write_frame({FrameKind::kCheckpoint, sizeof part, step, time}, std::as_bytes(std::span(&part, 1)));
}

void Link::offer(FrameKind kind, std::uint64_t step, double time, std::span<const std::byte> payload) {
  Waiting& w = *waiting_;
  // A corrupt tail gives a huge number here and so a drop; write_frame() is the one to complain.
  const std::uint64_t used = w.reports.used_by_writer(w.reports.load_tail());
  if (used + frame_bytes(payload.size()) > w.reports.capacity() / 2) {
    ++w.dropped;
    return;
  }
  w.put_frame({kind, static_cast<std::uint32_t>(payload.size()), step, time}, payload);
}

Status Link::finish(int exit_code, std::string_view json) {
  Waiting& w = *waiting_;
  const auto space = w.segment.records<std::byte>(self_ == Role::kFluid ? Part::kFluidFinal : Part::kRigidFinal);
  PeerLine& line = w.segment.peer(self_);
  const bool fits = json.size() <= space.size();
  if (fits && !json.empty()) std::memcpy(space.data(), json.data(), json.size());
  const int code = fits || exit_code != kFine ? exit_code : static_cast<int>(kProcessFailed);
  // relaxed, both: released by `state`
  line.final_bytes.store(fits ? json.size() : 0, std::memory_order_relaxed);
  line.exit_code.store(static_cast<std::uint32_t>(code), std::memory_order_relaxed);
  // release: partners are the acquires in Waiter::look_at and Control
  line.state.store(static_cast<std::uint32_t>(Attendance::kFinished), std::memory_order_release);
  w.tell_coordinator();
  const bool fluid = self_ == Role::kFluid;
  const Role peer = fluid ? Role::kRigid : Role::kFluid;
  // The peer may sleep on our mailbox: wake it. Its word has not moved, so it looks at us and sees the end.
  if (w.segment.takes_part(peer)) {
    const Header& h = w.segment.header();
    wake_if_sleeping(fluid ? h.order.sequence : h.answer.sequence, w.segment.peer(peer));
  }
  if (fits) return ok();
  return Error{
      "the final report has " + std::to_string(json.size()) + " bytes, room is for " + std::to_string(space.size()),
      "shorten it, or plan more final_bytes", "", kProcessFailed};
}

void Link::beat() { waiting_->waiter.beat(); }
double Link::seconds_waited() const { return waiting_->waiter.seconds(); }
std::uint64_t Link::waits() const { return waiting_->waiter.waits(); }
std::uint64_t Link::late_wakes() const { return waiting_->waiter.late_wakes(); }
std::uint64_t Link::blocked_reports() const { return waiting_->blocked; }
std::uint64_t Link::dropped_frames() const { return waiting_->dropped; }

}  // namespace ballast::exchange
