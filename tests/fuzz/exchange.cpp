// A peer writes anything anywhere in the segment: whoever reads it gets a value or an error, and stays within its
// memory. Input: records of target (1 byte: part, or kParts for the header), offset (2), length (1), bytes.
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "common/exchange/link.h"
#include "common/exchange/segment_impl.h"

namespace {

using namespace ballast;
using namespace ballast::exchange;

SegmentPlan plan() {
  SegmentPlan p;
  p.manifest.world.dimension = 3;
  for (int i = 0; i < 2; ++i) {
    BodyRecord body{};
    body.name[0] = 'a';
    body.orientation[0] = 1;
    body.first_shape = static_cast<std::uint32_t>(i);
    body.shape_count = 1;
    p.manifest.bodies.push_back(body);
    ShapeRecord shape{};
    shape.body = static_cast<std::uint32_t>(i);
    shape.vertex_count = 3;
    shape.triangle_count = 1;
    p.manifest.shapes.push_back(shape);
  }
  p.manifest.joints.push_back(JointRecord{});
  p.manifest.vertices.assign(9, 1.0);
  p.manifest.triangles = {0, 1, 2};
  p.scene_text = "ballast: 1\n";
  p.out_dir = "/tmp";
  p.contact_bytes = p.report_bytes = p.final_bytes = 4096;
  p.peer_timeout = 0.05;
  p.named = false;
  p.commands = true;
  return p;
}

void overlay(Segment::Impl& s, const Block (&parts)[kParts], const std::uint8_t* data, std::size_t size) {
  while (size >= 4) {
    const std::size_t target = data[0] % (kParts + 1), length = std::min<std::size_t>(data[3], size - 4);
    std::uint16_t offset = 0;
    std::memcpy(&offset, data + 1, 2);
    const Block block = target < kParts ? parts[target] : Block{0, kHeaderBytes};
    if (offset < block.bytes)
      std::memcpy(s.base() + block.offset + offset, data + 4, std::min<std::size_t>(length, block.bytes - offset));
    data += 4 + length;
    size -= 4 + length;
  }
}

volatile unsigned char sink = 0;
void touch(std::span<const std::byte> bytes) {
  for (std::byte b : bytes) sink = sink ^ static_cast<unsigned char>(b);
}

/// Reads all that a manifest offers, by its own indices.
void use(const ManifestView& m) {
  for (const BodyRecord& b : m.bodies) {
    touch(std::as_bytes(std::span(b.name, std::strlen(b.name))));
    touch(std::as_bytes(m.shapes.subspan(b.first_shape, b.shape_count)));
  }
  for (const ShapeRecord& s : m.shapes)
    for (std::uint32_t i = 0; i < 3 * s.triangle_count; ++i) {
      const std::uint32_t corner = m.triangles[3 * std::size_t{s.first_triangle} + i];
      touch(std::as_bytes(m.vertices.subspan(3 * (std::size_t{s.first_vertex} + corner), 3)));
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  auto made = Segment::create(Segment::make_name(), plan());
  if (!made) std::abort();
  Segment::Impl& s = made->impl();
  Block parts[kParts];
  std::copy(std::begin(s.header().parts), std::end(s.header().parts), parts);
  const Role role = data[0] & 1 ? Role::kFluid : Role::kRigid;
  const bool late = (data[0] & 2) != 0;  // after the peer has attached and believes the manifest
  if (!late) overlay(s, parts, data + 1, size - 1);
  auto mine = Segment::attach(made->path(), role);
  if (!mine) return 0;
  use(mine->manifest());
  touch(std::as_bytes(std::span(mine->scene_text())));
  if (!late || !mine->has(Role::kFluid) || !mine->has(Role::kRigid)) return 0;
  Header& h = s.header();
  const std::size_t n = mine->manifest().bodies.size();
  std::vector<BodyState> states(n);
  std::vector<Wrench> wrenches(n);
  std::vector<Contact> contacts;
  if (role == Role::kRigid) {
    RigidLink link(*mine);
    if (!link.send({}, states)) std::abort();
    overlay(s, parts, data + 1, size - 1);
    h.order.sequence.store(1);  // else it would wait
    if (auto order = link.receive(wrenches, contacts); order && !link.send({}, states)) std::abort();
  } else {
    FluidLink link(*mine);
    overlay(s, parts, data + 1, size - 1);
    h.answer.sequence.store(1);
    (void)link.receive(0, 0, states);
    (void)link.commands(1);
  }
  Control control(*made);
  std::vector<Frame> frames;
  for (Role from : {Role::kFluid, Role::kRigid}) {
    if (control.drain(from, frames)) {
      for (const Frame& f : frames)
        sink = static_cast<unsigned char>(f.contacts().size() + f.particles().size() + f.text().size());
    }
    const std::string report = control.final_report(from);
    touch(std::as_bytes(std::span(report)));
    sink = static_cast<unsigned char>(control.exit_code(from));
  }
  return 0;
}
