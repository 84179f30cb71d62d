// The shared-memory object: who may open it, what is refused, and that its name never outlives the run.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "common/exchange/segment_impl.h"
#include "tests/common/exchange/support.h"

namespace ballast::exchange::testing {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

std::string path_of(const std::string& name) { return "/dev/shm/" + name; }

struct Fixture {
  Result<Segment> segment = Segment::create(Segment::make_name(), plan_of(2));
  Header& header() { return segment->impl().header(); }
  std::string refusal() {
    auto other = Segment::attach(segment->name(), Role::kFluid);
    if (other) return "not refused";
    EXPECT_EQ(other.error().exit_code, kProcessFailed);
    EXPECT_EQ(other.error().where, path_of(segment->name()));
    EXPECT_FALSE(other.error().cure.empty());
    return other.error().what;
  }
};

TEST(segment, belongs_to_its_user_alone_whatever_the_umask) {
  const mode_t old = ::umask(0);
  Fixture f;
  ::umask(0777);
  Fixture g;
  ::umask(old);
  struct stat info {};
  for (Fixture* each : {&f, &g}) {
    ASSERT_TRUE(each->segment) << each->segment.error().text();
    ASSERT_EQ(::stat(path_of(each->segment->name()).c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 07777, 0600u);
    EXPECT_EQ(info.st_uid, ::geteuid());
    EXPECT_EQ(static_cast<std::size_t>(info.st_size), each->segment->bytes());
    EXPECT_GE(info.st_blocks * 512, info.st_size) << "all pages are reserved: a full /dev/shm shows at creation";
  }
}

TEST(segment, carries_the_plan_to_whoever_attaches) {
  SegmentPlan plan = plan_of(2);
  plan.manifest.shapes.assign(2, ShapeRecord{});
  plan.manifest.shapes[1].body = 1;
  plan.manifest.shapes[1].vertex_count = 3;
  plan.manifest.shapes[1].triangle_count = 1;
  plan.manifest.vertices = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  plan.manifest.triangles = {0, 1, 2};
  plan.manifest.joints.assign(1, JointRecord{});
  plan.manifest.joints[0].parent = -1;
  plan.threads = 7;
  auto segment = Segment::create(Segment::make_name(), plan);
  ASSERT_TRUE(segment) << segment.error().text();
  auto mine = Segment::attach(segment->name(), Role::kRigid);
  ASSERT_TRUE(mine) << mine.error().text();
  const ManifestView m = mine->manifest();
  EXPECT_EQ(std::memcmp(m.world, &plan.manifest.world, sizeof(WorldRecord)), 0);
  EXPECT_TRUE(same<BodyRecord>(m.bodies, plan.manifest.bodies));
  EXPECT_TRUE(same<ShapeRecord>(m.shapes, plan.manifest.shapes));
  EXPECT_TRUE(same<JointRecord>(m.joints, plan.manifest.joints));
  EXPECT_TRUE(same<double>(m.vertices, plan.manifest.vertices));
  EXPECT_TRUE(same<std::uint32_t>(m.triangles, plan.manifest.triangles));
  EXPECT_EQ(mine->scene_text(), plan.scene_text);
  EXPECT_EQ(mine->out_dir(), plan.out_dir);
  EXPECT_EQ(mine->threads(), 7u);
  EXPECT_TRUE(mine->has(Role::kFluid));
}

TEST(segment, refuses_a_name_that_is_taken_and_leaves_its_holder_alone) {
  Fixture f;
  auto second = Segment::create(f.segment->name(), plan_of(1));
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().exit_code, kProcessFailed);
  EXPECT_THAT(second.error().what, HasSubstr("exists already"));
  EXPECT_TRUE(in_shm(f.segment->name()));
  EXPECT_TRUE(Segment::attach(f.segment->name(), Role::kFluid));
  EXPECT_FALSE(Segment::create("../escape", plan_of(1)));
}

TEST(segment, more_than_dev_shm_holds_is_an_error_and_leaves_nothing) {
  SegmentPlan plan = plan_of(1);
  plan.final_bytes = std::size_t{1} << 44;
  const std::string name = Segment::make_name();
  auto segment = Segment::create(name, plan);
  ASSERT_FALSE(segment);
  EXPECT_EQ(segment.error().exit_code, kProcessFailed);
  EXPECT_THAT(segment.error().text(), HasSubstr("cannot reserve"));
  EXPECT_FALSE(in_shm(name));
}

TEST(segment, is_removed_by_its_creator_only) {
  std::string name;
  {
    Fixture f;
    name = f.segment->name();
    { auto guest = Segment::attach(name, Role::kFluid); }
    EXPECT_TRUE(in_shm(name)) << "a guest that leaves must not take the name away";
    Child fork([&] { return (void)Result<Segment>(std::move(f.segment)), 0; });
    EXPECT_EQ(fork.wait(), 0);
    EXPECT_TRUE(in_shm(name)) << "a forked child that inherited it must not, either";
  }
  EXPECT_FALSE(in_shm(name));
}

TEST(segment, without_a_name_is_attached_by_its_path_as_long_as_its_creator_has_it) {
  SegmentPlan plan = plan_of(2);
  plan.named = false;
  std::string path;
  {
    auto segment = Segment::create(Segment::make_name(), plan);
    ASSERT_TRUE(segment) << segment.error().text();
    EXPECT_FALSE(in_shm(segment->name()));
    path = segment->path();
    Child rigid([&] {
      auto mine = Segment::attach(path, Role::kRigid);
      return mine && mine->scene_text() == plan.scene_text ? 0 : 1;
    });
    EXPECT_EQ(rigid.wait(), 0);
    EXPECT_NE(Control(*segment).pid(Role::kRigid), 0) << "another piece of memory";
    EXPECT_FALSE(Segment::attach(path, Role::kRigid)) << "the role is taken";
  }
  auto gone = Segment::attach(path, Role::kFluid);
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().where, path);
}

TEST(segment, can_forget_its_name_while_others_hold_it) {
  Fixture f;
  auto mine = Segment::attach(f.segment->name(), Role::kRigid);
  ASSERT_TRUE(mine);
  f.segment->forget_name();
  EXPECT_FALSE(in_shm(f.segment->name()));
  EXPECT_NE(Control(*f.segment).pid(Role::kRigid), 0);
}

TEST(attach, refuses_a_role_that_is_taken) {
  Fixture f;
  auto first = Segment::attach(f.segment->name(), Role::kFluid);
  ASSERT_TRUE(first);
  EXPECT_THAT(f.refusal(), HasSubstr("a fluid process (pid " + std::to_string(::getpid()) + ") has already attached"));
  EXPECT_FALSE(Segment::attach(f.segment->name(), Role::kCoordinator));
}

TEST(attach, refuses_what_is_not_there) {
  auto none = Segment::attach("ballast-0-1-none", Role::kFluid);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().exit_code, kProcessFailed);
  EXPECT_THAT(none.error().text(), HasSubstr("/dev/shm/ballast-0-1-none: cannot be opened"));
}

TEST(attach, refuses_a_foreign_magic) {
  Fixture f;
  f.header().magic = kMagic + 1;
  EXPECT_THAT(f.refusal(), HasSubstr("magic"));
}
TEST(attach, refuses_another_version) {
  Fixture f;
  f.header().version = kProtocolVersion + 1;
  EXPECT_THAT(f.refusal(), HasSubstr("version is " + std::to_string(kProtocolVersion + 1)));
}
TEST(attach, refuses_another_layout) {
  Fixture f;
  f.header().layout_hash ^= 1;
  EXPECT_THAT(f.refusal(), HasSubstr("layout_hash"));
}
TEST(attach, refuses_a_size_that_is_not_the_files) {
  Fixture f;
  f.header().segment_bytes += 128;
  EXPECT_THAT(f.refusal(), HasSubstr("segment_bytes"));
}
TEST(attach, refuses_a_file_too_short_for_a_header) {
  Fixture f;
  ASSERT_EQ(::truncate(path_of(f.segment->name()).c_str(), 100), 0);
  EXPECT_THAT(f.refusal(), HasSubstr("shorter than a header: 100 bytes"));
}
TEST(attach, refuses_a_part_outside_the_segment) {
  for (std::size_t i = 0; i < kParts; ++i) {
    Fixture f;
    f.header().parts[i].offset = f.segment->bytes() + kLine;
    EXPECT_THAT(f.refusal(), HasSubstr("parts[" + std::to_string(i) + "] leaves the segment"));
    f.header().parts[i] = {kHeaderBytes, ~0ULL - 100};  // would wrap around in a careless sum
    EXPECT_THAT(f.refusal(), HasSubstr("parts[" + std::to_string(i) + "] leaves the segment"));
  }
}
TEST(attach, refuses_a_mode_that_lets_others_in) {
  for (mode_t mode : {0660, 0606, 0644, 0700}) {
    Fixture f;
    ASSERT_EQ(::chmod(path_of(f.segment->name()).c_str(), mode), 0);
    EXPECT_THAT(f.refusal(), HasSubstr("permission bits are not 0600"));
  }
}
/// Only root can give a file away, so the rule itself is asked.
TEST(attach, refuses_another_owner) {
  Fixture f;
  struct stat info {};
  ASSERT_EQ(::stat(path_of(f.segment->name()).c_str(), &info), 0);
  EXPECT_TRUE(check_file(info, info.st_uid));
  auto refused = check_file(info, info.st_uid + 1);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("owner (uid) is "));
}
TEST(attach, refuses_a_manifest_that_points_outside_itself) {
  Fixture f;
  BodyRecord& body = f.segment->impl().records<BodyRecord>(Part::kBodies)[1];
  body.first_shape = 5;
  EXPECT_THAT(f.refusal(), HasSubstr("first_shape of body 1"));
  body.first_shape = 0;
  std::memset(body.name, 'x', sizeof body.name);
  EXPECT_THAT(f.refusal(), HasSubstr("name of body 1"));
}
TEST(create, refuses_a_manifest_that_points_outside_itself) {
  SegmentPlan plan = plan_of(1);
  plan.manifest.shapes.assign(1, ShapeRecord{});
  plan.manifest.vertices.assign(9, 0.0);
  plan.manifest.triangles = {0, 1, 3};
  plan.manifest.shapes[0].vertex_count = 3;
  plan.manifest.shapes[0].triangle_count = 1;
  const std::string name = Segment::make_name();
  auto segment = Segment::create(name, plan);
  ASSERT_FALSE(segment);
  EXPECT_THAT(segment.error().what, HasSubstr("triangles of shape 0"));
  EXPECT_FALSE(in_shm(name));
}

TEST(stale, segments_of_dead_coordinators_are_removed_and_no_others) {
  Fixture living;
  std::string orphan = Segment::make_name();
  Child killed([&] {
    auto segment = Segment::create(orphan, plan_of(1));
    ::kill(::getpid(), SIGKILL);
    return 0;
  });
  EXPECT_EQ(killed.wait(), -SIGKILL);
  ASSERT_TRUE(in_shm(orphan));
  // A creator that died before it had written anything: only its name tells.
  const std::string unfinished = "ballast-" + std::to_string(::geteuid()) + "-4194305-00";  // above the kernel's limit
  const int file = ::shm_open(unfinished.c_str(), O_CREAT | O_EXCL | O_RDWR, 0600);
  ASSERT_GE(file, 0);
  ::close(file);
  // A later process with the same pid is not the coordinator: the start time differs.
  Fixture reborn;
  reborn.header().coordinator_start -= 1;
  const auto removed = Segment::remove_stale();
  EXPECT_THAT(removed, Contains(orphan));
  EXPECT_THAT(removed, Contains(unfinished));
  EXPECT_THAT(removed, Contains(reborn.segment->name()));
  EXPECT_THAT(removed, Not(Contains(living.segment->name())));
  EXPECT_FALSE(in_shm(orphan));
  EXPECT_FALSE(in_shm(unfinished));
  EXPECT_TRUE(in_shm(living.segment->name()));
}

}  // namespace
}  // namespace ballast::exchange::testing
