// What a segment must satisfy before this process believes a byte of it.
#include <bit>
#include <cmath>
#include <cstring>

#include "common/exchange/segment_impl.h"

namespace ballast::exchange {
namespace {

Error refused(const std::string& what, const std::string& cure) { return {what, cure, "", kProcessFailed}; }

template <class T>
Error unequal(const char* field, T seen, T expected, const char* cure) {
  return refused(std::string(field) + " is " + std::to_string(seen) + ", expected " + std::to_string(expected), cure);
}

constexpr const char* kRebuild = "coordinator, fluid and rigid process must come from the same build of Ballast";
constexpr const char* kDamaged = "the segment is damaged; start a new run";

Error out_of_range(const char* array, std::size_t index, const char* field) {
  return refused(
      std::string("manifest: ") + field + " of " + array + " " + std::to_string(index) + " points outside its array",
      kDamaged);
}

bool terminated(const char (&name)[64]) { return std::memchr(name, 0, sizeof name) != nullptr; }

bool within(std::uint64_t first, std::uint64_t count, std::uint64_t size) {
  return first <= size && count <= size - first;
}

Status check_shape(const ManifestView& m, std::size_t i) {
  const ShapeRecord& s = m.shapes[i];
  if (s.body >= m.bodies.size()) return out_of_range("shape", i, "body");
  if (!within(s.first_vertex, s.vertex_count, m.vertices.size() / 3)) return out_of_range("shape", i, "first_vertex");
  if (!within(s.first_triangle, s.triangle_count, m.triangles.size() / 3)) {
    return out_of_range("shape", i, "first_triangle");
  }
  for (std::uint32_t corner = 0; corner < 3 * s.triangle_count; ++corner) {
    if (m.triangles[3 * std::size_t{s.first_triangle} + corner] >= s.vertex_count) {
      return out_of_range("shape", i, "triangles");
    }
  }
  return ok();
}

}  // namespace

Status check_file(const struct stat& file, unsigned self) {
  if (!S_ISREG(file.st_mode)) return refused("is not a shared-memory object", "copy the run's name");
  if (file.st_uid != self) {
    return unequal("owner (uid)", file.st_uid, self, "run all processes of a run under the user who started it");
  }
  if ((file.st_mode & 07777) != 0600) {
    return refused("mode lets others in: permission bits are not 0600",
                   "someone changed them; remove the object and start a new run");
  }
  if (file.st_size < static_cast<off_t>(kHeaderBytes)) {
    return refused("is shorter than a header: " + std::to_string(file.st_size) + " bytes",
                   "its coordinator has not finished creating it, or died; start a new run");
  }
  return ok();
}

Status check_header(const Header& h, const Block (&parts)[kParts], std::uint64_t file_bytes) {
  // acquire: partner is the release at the end of create()
  if (h.magic.load(std::memory_order_acquire) != kMagic) {
    return refused("magic does not say Ballast", "copy the run's name; the coordinator prints it");
  }
  if (h.version != kProtocolVersion) return unequal("version", h.version, kProtocolVersion, kRebuild);
  if (h.header_bytes != kHeaderBytes) {
    return unequal("header_bytes", std::size_t{h.header_bytes}, kHeaderBytes, kRebuild);
  }
  if (h.layout_hash != layout_hash()) return unequal("layout_hash", h.layout_hash, layout_hash(), kRebuild);
  if (h.segment_bytes != file_bytes) return unequal("segment_bytes", h.segment_bytes, file_bytes, kDamaged);
  if (!(h.peer_timeout > 0)) return refused("peer_timeout is not positive", kDamaged);
  for (std::size_t i = 0; i < kParts; ++i) {
    const Block b = parts[i];
    if (b.offset % kLine != 0 || b.offset < kHeaderBytes || !within(b.offset, b.bytes, file_bytes)) {
      return refused("parts[" + std::to_string(i) + "] leaves the segment", kDamaged);
    }
  }
  const auto bytes = [&](Part part) { return parts[static_cast<std::size_t>(part)].bytes; };
  if (bytes(Part::kWorld) != sizeof(WorldRecord)) return refused("parts: the world has a wrong size", kDamaged);
  for (Part ring : {Part::kContacts, Part::kFluidReports, Part::kRigidReports, Part::kCommands}) {
    if (bytes(ring) != 0 && !std::has_single_bit(bytes(ring))) {
      return refused("parts: the size of a ring is no power of two", kDamaged);
    }
  }
  const std::uint64_t n = bytes(Part::kBodies) / sizeof(BodyRecord);
  if (h.fluid_takes_part && h.rigid_takes_part &&
      (bytes(Part::kOrder) != sizeof(Order) + n * sizeof(Wrench) + kMostCommands * sizeof(Command) ||
       bytes(Part::kAnswer) != sizeof(Answer) + n * sizeof(BodyState) || bytes(Part::kContacts) == 0)) {
    return refused("parts: a mailbox does not fit the number of bodies", kDamaged);
  }
  return ok();
}

Status check_manifest(const ManifestView& m) {
  if (m.world->dimension != 2 && m.world->dimension != 3) {
    return unequal("manifest: dimension", m.world->dimension, 3u, "a world has 2 or 3 dimensions");
  }
  for (std::size_t i = 0; i < m.bodies.size(); ++i) {
    const BodyRecord& b = m.bodies[i];
    if (!terminated(b.name)) return out_of_range("body", i, "name");
    if (!within(b.first_shape, b.shape_count, m.shapes.size())) return out_of_range("body", i, "first_shape");
  }
  for (std::size_t i = 0; i < m.shapes.size(); ++i) {
    if (auto good = check_shape(m, i); !good) return good;
  }
  for (std::size_t i = 0; i < m.joints.size(); ++i) {
    const JointRecord& j = m.joints[i];
    const auto count = static_cast<std::int64_t>(m.bodies.size());
    if (!terminated(j.name)) return out_of_range("joint", i, "name");
    if (j.parent < -1 || j.parent >= count) return out_of_range("joint", i, "parent");
    if (j.child < -1 || j.child >= count) return out_of_range("joint", i, "child");
  }
  return ok();
}

}  // namespace ballast::exchange
