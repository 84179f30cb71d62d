// Creating, attaching to and removing the run's shared-memory object.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <boost/interprocess/file_mapping.hpp>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <new>
#include <random>

#include "common/exchange/process.h"
#include "common/exchange/segment_impl.h"

namespace ballast::exchange {
namespace {

namespace bip = boost::interprocess;

constexpr const char* kFolder = "/dev/shm/";
constexpr std::size_t kCommandBytes = 1 << 20;  // 10 000 commands; a replay has all of its own in it from the start

/// Path of a segment without a name: /proc/<pid of its coordinator>/fd/<number>.
bool is_path(const std::string& name) { return name.starts_with("/proc/"); }

Error failure(const std::string& name, const std::string& what, const std::string& cure) {
  return {what, cure, is_path(name) ? name : kFolder + name, kProcessFailed};
}

bool good_name(const std::string& name) {
  return !name.empty() && name.size() < 200 && name.find('/') == std::string::npos && name[0] != '.';
}

std::uint64_t round_up(std::uint64_t bytes) { return (bytes + kLine - 1) / kLine * kLine; }

/// A ring's size: a power of two, at least one page, at most 1 GiB, since its counters have 32 bits.
std::uint64_t ring_bytes(std::size_t wanted) {
  return std::bit_ceil(std::clamp<std::uint64_t>(wanted, 4096, std::uint64_t{1} << 30));
}

/// Sizes and offsets of all parts; what does not take part in the run gets no bytes.
std::uint64_t lay_out(const SegmentPlan& plan, Block (&parts)[kParts]) {
  const Manifest& m = plan.manifest;
  const std::uint64_t n = m.bodies.size();
  const bool both = plan.fluid && plan.rigid;
  // At least one patch per body must fit, so that merging per body always ends the shortage.
  const std::uint64_t contacts = both ? ring_bytes(std::max(plan.contact_bytes, n * sizeof(Contact))) : 0;
  const std::uint64_t bytes[kParts] = {
      sizeof(WorldRecord),
      n * sizeof(BodyRecord),
      m.shapes.size() * sizeof(ShapeRecord),
      m.joints.size() * sizeof(JointRecord),
      m.vertices.size() * sizeof(double),
      m.triangles.size() * sizeof(std::uint32_t),
      plan.scene_text.size(),
      plan.out_dir.size(),
      both ? sizeof(Order) + n * sizeof(Wrench) + kMostCommands * sizeof(Command) : 0,
      both ? sizeof(Answer) + n * sizeof(BodyState) : 0,
      contacts,
      plan.fluid ? ring_bytes(plan.report_bytes) : 0,
      plan.rigid ? ring_bytes(plan.report_bytes) : 0,
      plan.fluid ? plan.final_bytes : 0,
      plan.rigid ? plan.final_bytes : 0,
      plan.resume_dir.size(),
      plan.commands ? ring_bytes(kCommandBytes) : 0,
  };
  std::uint64_t end = kHeaderBytes;
  for (std::size_t i = 0; i < kParts; ++i) {
    parts[i] = {end, bytes[i]};
    end += round_up(bytes[i]);
  }
  return end;
}

ManifestView view_of(const Segment::Impl& s) {
  const auto world = s.records<WorldRecord>(Part::kWorld);
  return {world.data(),
          s.records<BodyRecord>(Part::kBodies),
          s.records<ShapeRecord>(Part::kShapes),
          s.records<JointRecord>(Part::kJoints),
          s.records<double>(Part::kVertices),
          s.records<std::uint32_t>(Part::kTriangles)};
}

void copy_in(const Segment::Impl& s, Part part, const void* from) {
  const Block b = s.block(part);
  if (b.bytes != 0) std::memcpy(s.base() + b.offset, from, b.bytes);
}

void fill_header(Header& h, const SegmentPlan& plan, const Block (&parts)[kParts], std::uint64_t bytes) {
  h.version = kProtocolVersion;
  h.header_bytes = kHeaderBytes;
  h.layout_hash = layout_hash();
  h.segment_bytes = bytes;
  h.coordinator_pid = static_cast<std::uint32_t>(::getpid());
  h.owner_uid = ::geteuid();
  h.coordinator_start = start_time(h.coordinator_pid);
  std::random_device random;
  h.run_id = (std::uint64_t{random()} << 32) | random();
  h.peer_timeout = plan.peer_timeout;
  h.fluid_takes_part = plan.fluid;
  h.rigid_takes_part = plan.rigid;
  h.threads = plan.threads;
  h.monitor = plan.monitor;
  h.first_step = plan.first_step;
  h.checkpoint_every = plan.checkpoint_every;
  std::copy(std::begin(parts), std::end(parts), h.parts);
  PeerLine& self = h.peers[static_cast<std::size_t>(Role::kCoordinator)];
  // relaxed: nobody reads any of this before it has seen `magic`, which is released last
  self.pid.store(h.coordinator_pid, std::memory_order_relaxed);
  self.start_time.store(h.coordinator_start, std::memory_order_relaxed);
  self.state.store(static_cast<std::uint32_t>(Attendance::kRunning), std::memory_order_relaxed);
}

Result<bip::mapped_region> reserve_and_map(const std::string& name, bip::shared_memory_object& object,
                                           std::uint64_t bytes) {
  // Pages of a sparse object are found only when touched, and a full /dev/shm would then be a SIGBUS in mid-run.
  int code;
  do code = ::posix_fallocate(object.get_mapping_handle().handle, 0, static_cast<off_t>(bytes));
  while (code == EINTR);
  if (code != 0) {
    return failure(name, "cannot reserve " + std::to_string(bytes) + " bytes of shared memory: " + std::strerror(code),
                   "free some of /dev/shm (df -h /dev/shm; containers: --shm-size=1g)");
  }
  return bip::mapped_region(object, bip::read_write, 0, bytes);
}

Status claim(Segment::Impl& s, Role role) {
  if (!s.takes_part(role) || role == Role::kCoordinator) {
    return failure(s.name, std::string("the ") + role_name(role) + " is not part of this run",
                   "start it only where `ballast plan` lists it");
  }
  PeerLine& line = s.peer(role);
  const auto self = static_cast<std::uint32_t>(::getpid());
  std::uint32_t holder = 0;
  // acq_rel: of two that claim at once, one sees the other's pid; nothing else is published by it
  if (!line.pid.compare_exchange_strong(holder, self, std::memory_order_acq_rel)) {
    return failure(s.name,
                   std::string("a ") + role_name(role) + " (pid " + std::to_string(holder) + ") has already attached",
                   "one process per role and run; start a new run");
  }
  // relaxed, since `state` releases it to those who acquire kRunning (Waiter, Control::state)
  line.start_time.store(start_time(self), std::memory_order_relaxed);
  line.state.store(static_cast<std::uint32_t>(Attendance::kRunning), std::memory_order_release);
  return ok();
}

std::string to_hex(std::uint64_t value) {
  std::string text(16, '0');
  for (int i = 15; i >= 0; --i, value >>= 4) text[static_cast<std::size_t>(i)] = "0123456789abcdef"[value & 15];
  return text;
}

/// Segments of another version, and those whose creator died before finishing them, are judged by what they have.
bool is_stale(const std::string& name) {
  const int file = ::shm_open(name.c_str(), O_RDONLY, 0);
  if (file < 0) return false;
  struct stat info {};
  alignas(Header) char bytes[64] = {};
  const bool known = ::fstat(file, &info) == 0 && info.st_uid == ::geteuid();
  const bool complete = known && ::pread(file, bytes, sizeof bytes, 0) == sizeof bytes;
  ::close(file);
  if (!known) return false;
  std::uint64_t magic = 0, start = 0;
  std::uint32_t pid = 0;
  std::memcpy(&magic, bytes + offsetof(Header, magic), 8);
  std::memcpy(&pid, bytes + offsetof(Header, coordinator_pid), 4);
  std::memcpy(&start, bytes + offsetof(Header, coordinator_start), 8);
  if (complete && magic == kMagic) return !alive(pid, start);
  const std::size_t dash = name.find('-', sizeof("ballast-") - 1);  // ballast-<uid>-<pid>-<random>
  const unsigned long creator = dash == std::string::npos ? 0 : std::strtoul(name.c_str() + dash + 1, nullptr, 10);
  return creator != 0 && creator <= std::numeric_limits<std::uint32_t>::max() &&
         !alive(static_cast<std::uint32_t>(creator), 0);
}

}  // namespace

const char* role_name(Role role) {
  switch (role) {
    case Role::kFluid:
      return "fluid process";
    case Role::kRigid:
      return "rigid process";
    case Role::kCoordinator:
      return "coordinator";
  }
  return "unknown process";
}

bool Segment::Impl::takes_part(Role role) const {
  const Header& h = header();
  return role == Role::kCoordinator || (role == Role::kFluid ? h.fluid_takes_part : h.rigid_takes_part) != 0;
}

void Segment::Impl::remove_if_orphaned() const {
  const Header& h = header();
  if (!alive(h.coordinator_pid, h.coordinator_start)) Segment::remove(name);
}

Segment::Impl::~Impl() {
  if (creator == ::getpid()) {  // a forked child that inherited the mapping must not take the name away
    Segment::remove(name);
  } else if (creator == 0) {
    remove_if_orphaned();
  }
}

Result<Segment> Segment::create(const std::string& name, const SegmentPlan& plan) try {
  if (!good_name(name)) return failure(name, "this cannot be the name of a shared-memory object", "use make_name()");
  Block parts[kParts];
  const std::uint64_t bytes = lay_out(plan, parts);
  auto impl = std::make_unique<Impl>();
  impl->name = name;
  bip::shared_memory_object object(bip::create_only, name.c_str(), bip::read_write, bip::permissions(0600));
  impl->creator = ::getpid();  // from here on the destructor removes the name, whatever goes wrong
  if (!plan.named) {
    // At once: from here on the kernel frees it with the last of its processes, however they end.
    Segment::remove(name);
    impl->path = "/proc/" + std::to_string(impl->creator) + "/fd/" + std::to_string(object.get_mapping_handle().handle);
  }
  auto region = reserve_and_map(name, object, bytes);
  if (!region) return region.error();
  impl->region.swap(*region);
  std::uninitialized_default_construct_n(&impl->header(), 1);  // the object is all zero; this starts the atomics' lives
  fill_header(impl->header(), plan, parts, bytes);
  std::copy(std::begin(parts), std::end(parts), impl->parts);
  const Manifest& m = plan.manifest;
  copy_in(*impl, Part::kWorld, &m.world);
  copy_in(*impl, Part::kBodies, m.bodies.data());
  copy_in(*impl, Part::kShapes, m.shapes.data());
  copy_in(*impl, Part::kJoints, m.joints.data());
  copy_in(*impl, Part::kVertices, m.vertices.data());
  copy_in(*impl, Part::kTriangles, m.triangles.data());
  copy_in(*impl, Part::kSceneText, plan.scene_text.data());
  copy_in(*impl, Part::kOutDir, plan.out_dir.data());
  copy_in(*impl, Part::kResumeDir, plan.resume_dir.data());
  impl->manifest = view_of(*impl);
  if (auto good = check_manifest(impl->manifest); !good) return good.error();
  // release: partner is the acquire in attach(); whoever sees the magic sees everything above
  impl->header().magic.store(kMagic, std::memory_order_release);
  if (!plan.named) impl->object.swap(object);  // open as long as others may attach
  return Segment(std::move(impl));
} catch (const bip::interprocess_exception& e) {
  const bool taken = e.get_error_code() == bip::already_exists_error;
  return failure(name, taken ? "a shared-memory object of this name exists already" : e.what(),
                 taken ? "choose another name, or remove the old run's with `rm`" : "check /dev/shm");
}

Result<Segment> Segment::attach(const std::string& name, Role role) try {
  if (is_path(name)) return map_and_claim(name, role, bip::file_mapping(name.c_str(), bip::read_write));
  if (!good_name(name))
    return failure(name, "this cannot be the name of a shared-memory object", "copy the run's name");
  return map_and_claim(name, role, bip::shared_memory_object(bip::open_only, name.c_str(), bip::read_write));
} catch (const bip::interprocess_exception& e) {
  return failure(name, std::string("cannot be opened: ") + e.what(),
                 "is the coordinator of this run still alive, and does it run under this user?");
}

template <class Object>
Result<Segment> Segment::map_and_claim(const std::string& name, Role role, const Object& object) {
  struct stat info {};
  if (::fstat(object.get_mapping_handle().handle, &info) != 0) {
    return failure(name, std::string("cannot be examined: ") + std::strerror(errno), "check /dev/shm");
  }
  if (auto good = check_file(info, ::geteuid()); !good) {
    return failure(name, good.error().what, good.error().cure);
  }
  auto impl = std::make_unique<Impl>();
  impl->name = name;
  impl->region = bip::mapped_region(object, bip::read_write, 0, static_cast<std::size_t>(info.st_size));
  std::copy(std::begin(impl->header().parts), std::end(impl->header().parts), impl->parts);
  if (auto good = check_header(impl->header(), impl->parts, static_cast<std::uint64_t>(info.st_size)); !good) {
    return failure(name, good.error().what, good.error().cure);
  }
  impl->manifest = view_of(*impl);
  if (auto good = check_manifest(impl->manifest); !good) return failure(name, good.error().what, good.error().cure);
  if (auto good = claim(*impl, role); !good) return good.error();
  impl->creator = 0;
  return Segment(std::move(impl));
}

void Segment::forget_name() { remove(impl_->name); }

std::string Segment::make_name() {
  std::random_device random;
  return "ballast-" + std::to_string(::geteuid()) + "-" + std::to_string(::getpid()) + "-" +
         to_hex((std::uint64_t{random()} << 32) | random());
}

void Segment::remove(const std::string& name) {
  if (good_name(name)) bip::shared_memory_object::remove(name.c_str());
}

std::vector<std::string> Segment::remove_stale() {
  const std::string prefix = "ballast-" + std::to_string(::geteuid()) + "-";
  std::vector<std::string> removed;
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder, failed)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(prefix, 0) != 0 || !is_stale(name)) continue;
    remove(name);
    removed.push_back(name);
  }
  return removed;
}

Segment::Segment(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Segment::Segment(Segment&&) noexcept = default;
Segment& Segment::operator=(Segment&&) noexcept = default;
Segment::~Segment() = default;

const std::string& Segment::name() const { return impl_->name; }
const std::string& Segment::path() const { return impl_->path.empty() ? impl_->name : impl_->path; }
ManifestView Segment::manifest() const { return impl_->manifest; }
std::string_view Segment::scene_text() const {
  const auto text = impl_->records<char>(Part::kSceneText);
  return {text.data(), text.size()};
}
std::string Segment::out_dir() const {
  const auto text = impl_->records<char>(Part::kOutDir);
  return {text.data(), text.size()};
}
std::string Segment::resume_dir() const {
  const auto text = impl_->records<char>(Part::kResumeDir);
  return {text.data(), text.size()};
}
std::uint64_t Segment::first_step() const { return impl_->header().first_step; }
double Segment::checkpoint_every() const { return impl_->header().checkpoint_every; }
std::uint32_t Segment::threads() const { return impl_->header().threads; }
bool Segment::wants(FrameKind kind) const { return (impl_->header().monitor & monitor_bit(kind)) != 0; }
bool Segment::has(Role role) const { return impl_->takes_part(role); }
std::size_t Segment::bytes() const { return impl_->region.get_size(); }

}  // namespace ballast::exchange
