// The lockstep itself: orders from the fluid, answers from the rigid process.
#include <cmath>
#include <cstring>

#include "common/exchange/hash.h"
#include "common/exchange/link_impl.h"

namespace ballast::exchange {
namespace {

/// One patch per body that stands for all of its patches: forces add, places and normals are means weighted by area.
std::span<const Contact> merge_per_body(std::span<const Contact> contacts, std::vector<Contact>& merged) {
  std::fill(merged.begin(), merged.end(), Contact{});
  for (const Contact& c : contacts) {
    Contact& m = merged[c.body];
    m.depth = m.samples == 0 && m.area == 0 ? c.depth : std::max(m.depth, c.depth);
    m.body = 1;  // marks the entry as used until the end
    m.samples += c.samples;
    m.area += c.area;
    for (int k = 0; k < 3; ++k) {
      m.position[k] += c.area * c.position[k];
      m.normal[k] += c.area * c.normal[k];
      m.force[k] += c.force[k];
    }
  }
  std::size_t used = 0;
  for (std::size_t body = 0; body < merged.size(); ++body) {
    Contact m = merged[body];
    if (m.body == 0) continue;
    m.body = static_cast<std::uint32_t>(body);
    const double length = std::hypot(m.normal[0], m.normal[1], m.normal[2]);
    for (int k = 0; k < 3; ++k) {
      if (m.area > 0) m.position[k] /= m.area;
      if (length > 0) m.normal[k] /= length;  // a body wetted all round has no mean normal: it stays zero
    }
    merged[used++] = m;
  }
  return {merged.data(), used};
}

std::byte* payload(Segment::Impl& s, Part part) { return s.base() + s.block(part).offset; }

}  // namespace

FluidLink::FluidLink(Segment& segment) : Link(segment, Role::kFluid) {}
RigidLink::RigidLink(Segment& segment) : Link(segment, Role::kRigid) {}
std::uint64_t FluidLink::contacts_merged() const { return waiting_->contacts_merged; }

Status FluidLink::send(Order order, std::span<const Wrench> wrenches, std::span<const Contact> contacts,
                       std::span<const Command> commands) {
  Waiting& w = *waiting_;
  const std::size_t n = w.segment.manifest.bodies.size();
  if (!w.segment.takes_part(Role::kRigid)) return misuse("send(): no rigid process takes part in this run");
  if (w.posted + 1 != w.received) return misuse("send() without receive() before it");
  if (wrenches.size() != n) return misuse("send(): one wrench per body of the manifest is needed");
  if (commands.size() > kMostCommands) return misuse("send(): more commands than an order has room for");
  for (const Contact& c : contacts) {
    if (c.body >= n) return misuse("send(): a contact's body index is outside the manifest");
  }
  const std::uint32_t used = w.contacts.used_by_writer(w.contacts.load_tail());
  if (used > w.contacts.capacity()) {
    return bad_field(w.expected(Role::kRigid), "tail of the contact ring", "past head", "at most head");
  }
  if (contacts.size_bytes() > w.contacts.capacity() - used) {
    const std::size_t before = contacts.size();
    contacts = merge_per_body(contacts, w.merged);
    w.contacts_merged += before - contacts.size();
  }
  order.bodies = static_cast<std::uint32_t>(n);
  order.contacts = static_cast<std::uint32_t>(contacts.size());
  order.contacts_lost = w.contacts_merged;
  order.commands = static_cast<std::uint32_t>(commands.size());
  w.contacts.put(0, contacts.data(), contacts.size_bytes());
  w.contacts.publish(static_cast<std::uint32_t>(contacts.size_bytes()));
  std::byte* to = payload(w.segment, Part::kOrder);
  std::memcpy(to, &order, sizeof order);
  if (n != 0) std::memcpy(to + sizeof order, wrenches.data(), wrenches.size_bytes());
  if (!commands.empty()) std::memcpy(to + sizeof order + wrenches.size_bytes(), commands.data(), commands.size_bytes());
  w.asleep = (order.flags & kAsleep) != 0 && commands.empty();
  w.step = order.step;
  w.iteration = order.iteration;
  w.waiter.note_step(order.step);
  w.waiter.beat();
  w.post(w.segment.header().order, Role::kRigid);
  return ok();
}

Result<Answer> FluidLink::receive(std::uint64_t step, std::uint32_t iteration, std::span<BodyState> states) {
  Waiting& w = *waiting_;
  if (!w.segment.takes_part(Role::kRigid)) return misuse("receive(): no rigid process takes part in this run");
  if (w.posted != w.received) return misuse("receive() without send() before it");
  if (states.size() != w.segment.manifest.bodies.size()) return misuse("receive(): one state per body is needed");
  w.step = step;
  w.iteration = iteration;
  auto end = w.await_message(w.segment.header().answer, Role::kRigid);
  if (!end) return end.error();
  const Expected expected = w.expected(Role::kRigid);
  if (*end == Waiter::End::kPeerFinished) {
    return Error{"the rigid process (pid " + std::to_string(expected.pid) + ") finished without an answer to step " +
                     std::to_string(step),
                 "it must answer every order until one carries kLast", "", kProcessFailed};
  }
  const std::byte* from = payload(w.segment, Part::kAnswer);
  Answer answer;
  std::memcpy(&answer, from, sizeof answer);
  const std::uint64_t before = w.asleep ? state_hash(states) : 0;
  if (!states.empty()) std::memcpy(states.data(), from + sizeof answer, states.size_bytes());
  const ManifestView& m = w.segment.manifest;
  if (auto good = check_answer(answer, expected, m); !good) return good.error();
  if (auto good = check_states(states, expected, m); !good) return good.error();
  if (w.asleep && state_hash(states) != before)
    return bad_field(expected, "states in a step asleep", "of bodies that have moved", "those of the step before");
  return answer;
}

Result<Order> RigidLink::receive(std::span<Wrench> wrenches, std::vector<Contact>& contacts) {
  Waiting& w = *waiting_;
  if (!w.segment.takes_part(Role::kFluid)) return misuse("receive(): no fluid process takes part in this run");
  if (w.posted != w.received + 1) return misuse("receive() without send() before it");
  if (wrenches.size() != w.segment.manifest.bodies.size()) return misuse("receive(): one wrench per body is needed");
  auto end = w.await_message(w.segment.header().order, Role::kFluid);
  if (!end) return end.error();
  Order order{};
  if (*end == Waiter::End::kPeerFinished) {  // stopped between two steps
    order.step = w.step;
    order.iteration = w.iteration;
    order.flags = kLast | kEnd;
    contacts.clear();
    w.commands.clear();
    return order;
  }
  const Expected expected = w.expected(Role::kFluid);
  const std::byte* from = payload(w.segment, Part::kOrder);
  std::memcpy(&order, from, sizeof order);
  if (!wrenches.empty()) std::memcpy(wrenches.data(), from + sizeof order, wrenches.size_bytes());
  const ManifestView& m = w.segment.manifest;
  if (auto good = check_order(order, expected, m); !good) return good.error();
  if (auto good = check_wrenches(wrenches, expected, m); !good) return good.error();
  w.commands.resize(order.commands);
  if (!w.commands.empty())
    std::memcpy(w.commands.data(), from + sizeof order + wrenches.size_bytes(), order.commands * sizeof(Command));
  for (const Command& c : w.commands)
    if (auto good = check_command(c, expected, m); !good) return good.error();
  const std::uint32_t bytes = w.contacts.readable();
  if (bytes > w.contacts.capacity() || bytes != order.contacts * sizeof(Contact)) {
    return bad_field(expected, "contacts", std::to_string(order.contacts),
                     "what lies in the ring: " + std::to_string(bytes) + " bytes");
  }
  contacts.resize(order.contacts);
  w.contacts.get(0, contacts.data(), bytes);
  w.contacts.release_to_writer(bytes);
  if (auto good = check_contacts(contacts, expected, m); !good) return good.error();
  w.step = order.step;
  w.iteration = order.iteration;
  w.waiter.note_step(order.step);
  return order;
}

std::span<const Command> RigidLink::ordered_commands() const { return waiting_->commands; }

Status RigidLink::send(Answer answer, std::span<const BodyState> states) {
  Waiting& w = *waiting_;
  const std::size_t n = w.segment.manifest.bodies.size();
  if (!w.segment.takes_part(Role::kFluid)) return misuse("send(): no fluid process takes part in this run");
  if (w.posted != w.received) return misuse("send() without receive() before it");
  if (states.size() != n) return misuse("send(): one state per body of the manifest is needed");
  answer.bodies = static_cast<std::uint32_t>(n);
  std::byte* to = payload(w.segment, Part::kAnswer);
  std::memcpy(to, &answer, sizeof answer);
  if (n != 0) std::memcpy(to + sizeof answer, states.data(), states.size_bytes());
  w.waiter.beat();
  w.post(w.segment.header().answer, Role::kFluid);
  return ok();
}

}  // namespace ballast::exchange
