// Any bytes on the channel of commands are a command or none; what they ask for is obeyed or refused with a reason, and
// what the record keeps of it is JSON that a replay reads.
#include <ballast/command_t.hpp>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "common/scene/reader.h"
#include "launch/act.h"
#include "launch/command_message.h"

namespace {

using namespace ballast;
using namespace ballast::launch;

constexpr const char* kScene =
    "ballast: 1\n"
    "world: { duration: 1 s, spacing: 5 cm }\n"
    "fluids: [ { name: water, material: water, fill: { box: { min: [0, 0, 0], max: [1, 1, 0.5] } } } ]\n"
    "models:\n"
    "  - { name: tank, static: true, shape: { open_box: { inside: [1, 1, 1] } } }\n"
    "  - { name: box, shape: { box: [0.2, 0.2, 0.2] }, density: 500, pose: [0.3, 0.3, 0.7] }\n";

Prepared prepared() {
  auto scene = read_scene_text(kScene, "fuzz.yaml");
  if (!scene) std::abort();
  auto bodies = make_bodies(*scene);
  if (!bodies) std::abort();
  return {std::move(*scene), std::move(*bodies), true, true, {}};
}

/// A command that is sent on is finite, and comes out of the record as it went in.
void act(const RunCommand& command, const Prepared& where) {
  const auto sent = to_exchange(command, where);
  if (!sent) {
    if (sent.error().what.empty()) std::abort();
    return;
  }
  const auto again = from_json(nlohmann::json::parse(to_json(command).dump()));
  if (!again || to_json(*again) != to_json(command)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Prepared where = prepared();
  static Obey obey;
  static std::uint64_t taken = 0;
  // The hash that begins a message is nobody's guess.
  std::vector<std::uint8_t> bytes(8);
  const auto hash = static_cast<std::uint64_t>(command_t::getHash());
  for (std::size_t k = 0; k < 8; ++k) bytes[k] = static_cast<std::uint8_t>(hash >> (56 - 8 * k));
  bytes.insert(bytes.end(), data, data + size);
  const auto command = read_command(bytes.data(), bytes.size());
  if (!command) return 0;
  if (++taken % 1000 == 0) obey = Obey();
  if (acts(*command)) {
    act(*command, where);
    obey.add(to_json(*command));
  } else {
    obey.take(*command, taken, 0);
  }
  if (obey.paused() != obey.limit().has_value()) std::abort();
  (void)obey.record().back().dump();  // throws where a text is none
  return 0;
}
