// Seeds that hang on the layout of messages and of the shared memory, made anew by every build: kept as files they
// would stop being what they are meant to be with the next change of a record. seeds FOLDER writes FOLDER/TARGET/NAME.
#include <ballast/body_states_t.hpp>
#include <ballast/command_t.hpp>
#include <ballast/contact_sets_t.hpp>
#include <ballast/fluid_statistics_t.hpp>
#include <ballast/particles_t.hpp>
#include <ballast/status_t.hpp>
#include <ballast/warning_t.hpp>
#include <ballast/wrenches_t.hpp>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "common/exchange/layout.h"
#include "common/exchange/records.h"
#include "monitor/message_type.h"

namespace {

using namespace ballast;
using namespace ballast::exchange;
namespace fs = std::filesystem;

fs::path folder;

void write(const char* target, const std::string& name, const std::string& bytes) {
  fs::create_directories(folder / target);
  std::ofstream(folder / target / name, std::ios::binary) << bytes;
}

template <class Message>
std::string encoded(const Message& message) {
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), 0);
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// As fuzz_command reads them: without the hash.
void command(const char* action, const char* body, double value = 0) {
  command_t c{};
  c.action = action, c.body = body, c.steps = 10, c.duration = 0.1;
  c.force[2] = c.torque[1] = c.position[0] = value;
  c.orientation[0] = 1;
  c.gravity[2] = -value;
  write("command", std::string(action) + (*body ? std::string("_") + body : ""), encoded(c).substr(8));
}

/// As fuzz_message reads them: which type, then the message without its hash.
template <class Message>
void message(const char* name, const Message& m) {
  const std::string bytes = encoded(m);
  int count = 0;
  const ballast_message_type_t* types = ballast_message_types(&count);
  const auto index = monitor::type_of(bytes.data(), bytes.size()) - types;
  write("message", name, static_cast<char>(index) + bytes.substr(8));
}

void messages() {
  message("command", command_t{});
  message("status", status_t{});
  message("fluid", fluid_statistics_t{});
  message("warning", warning_t{});
  body_states_t bodies{};
  wrenches_t wrenches{};
  contact_sets_t contacts{};
  bodies.count = wrenches.count = contacts.count = 2;
  bodies.chunks = wrenches.chunks = contacts.chunks = 1;
  bodies.bodies.resize(2), wrenches.wrenches.resize(2), contacts.contacts.resize(2);
  bodies.bodies[1].name = wrenches.wrenches[1].body = contacts.contacts[1].body = "box";
  message("bodies", bodies);
  message("wrenches", wrenches);
  message("contacts", contacts);
  particles_t particles{};
  particles.count = particles.shown = 2, particles.chunks = 1;
  particles.id.resize(2);
  for (auto* list :
       {&particles.x, &particles.y, &particles.z, &particles.vx, &particles.vy, &particles.vz, &particles.pressure})
    list->resize(2);
  message("particles", particles);
}

/// An input of fuzz_exchange: who reads and when, then what lies where.
struct Segment {
  std::string bytes;
  explicit Segment(bool fluid, bool late) : bytes(1, static_cast<char>((fluid ? 1 : 0) | (late ? 2 : 0))) {}
  Segment& at(std::size_t target, std::size_t offset, const void* from, std::size_t length) {
    bytes += {static_cast<char>(target), static_cast<char>(offset & 255), static_cast<char>(offset >> 8),
              static_cast<char>(length)};
    bytes.append(static_cast<const char*>(from), length);
    return *this;
  }
  template <class T>
  Segment& part(Part p, std::size_t offset, const T& value) {
    return at(static_cast<std::size_t>(p), offset, &value, sizeof value);
  }
  template <class T>
  Segment& header(std::size_t offset, T value) {
    return at(kParts, offset, &value, sizeof value);
  }
};

Order order(std::uint32_t contacts) {
  Order o{};
  o.step = 1, o.dt = o.next_dt = 1e-3, o.bodies = 2, o.contacts = contacts;
  return o;
}

Segment answer() {
  Segment s(true, true);
  Answer a{};
  a.bodies = 2;
  s.part(Part::kAnswer, 0, a);
  for (std::size_t body = 0; body < 2; ++body)
    s.part(Part::kAnswer, sizeof(Answer) + body * sizeof(BodyState) + offsetof(BodyState, orientation), 1.0);
  return s;
}

void exchanges() {
  constexpr std::size_t kHead = offsetof(RingCounters, head);
  write("exchange", "order", Segment(false, true).part(Part::kOrder, 0, order(0)).bytes);
  write("exchange", "contacts",
        Segment(false, true)
            .part(Part::kOrder, 0, order(1))
            .header<std::uint32_t>(offsetof(Header, contacts) + kHead, sizeof(Contact))
            .bytes);
  write("exchange", "contacts_beyond_the_ring",
        Segment(false, true)
            .part(Part::kOrder, 0, order(86))
            .header<std::uint32_t>(offsetof(Header, contacts) + kHead, 86 * sizeof(Contact))
            .bytes);
  write("exchange", "answer", answer().bytes);
  struct {
    FrameHead head{FrameKind::kWarning, 8, 1, 0.5};
    char text[9] = "a warnin";
  } frame;
  write("exchange", "frame",
        Segment(true, true)
            .part(Part::kFluidReports, 0, frame)
            .header<std::uint32_t>(offsetof(Header, fluid_reports) + kHead, sizeof(FrameHead) + 8)
            .bytes);
  write("exchange", "final",
        Segment(true, true)
            .at(static_cast<std::size_t>(Part::kFluidFinal), 0, "{\"a\":1}", 7)
            .header<std::uint32_t>(offsetof(Header, peers) + offsetof(PeerLine, state), 2)
            .header<std::uint64_t>(offsetof(Header, peers) + offsetof(PeerLine, final_bytes), 7)
            .bytes);
  write(
      "exchange", "shape_beyond_the_vertices",
      Segment(false, false).part(Part::kShapes, offsetof(ShapeRecord, first_vertex), std::uint32_t{0x01000000}).bytes);
  write("exchange", "parts_moved_after_the_check",
        Segment(true, true)
            .header<Block>(offsetof(Header, parts) + static_cast<std::size_t>(Part::kAnswer) * sizeof(Block),
                           {0x100000, 4})
            .bytes);
  write("exchange", "parts_moved_before_the_check",
        Segment(true, false)
            .header<Block>(offsetof(Header, parts) + static_cast<std::size_t>(Part::kAnswer) * sizeof(Block),
                           {0x100000, 4})
            .bytes);
  Command c{1, 0, CommandKind::kPose, 1, {0, 0, 1, 1}, 0};
  write("exchange", "command",
        Segment(true, true)
            .part(Part::kCommands, 0, c)
            .header<std::uint32_t>(offsetof(Header, commands) + kHead, sizeof(Command))
            .bytes);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]), 2;
  folder = argv[1];
  for (const char* action : {"pause", "step", "resume", "stop", "fly"}) command(action, "");
  command("wrench", "box", 20), command("pose", "box", 0.5), command("pose", "tank", 0.5), command("wrench", "bux", 1);
  command("gravity", "", 1.62);
  messages();
  exchanges();
  return 0;
}
