// The only place where the processes meet: one shared-memory segment with manifest, two mailboxes, rings and control
// words. Waiting is a futex without spinning, in slices of at most 100 ms that each end with a peer-alive test.
// Protocol page: README.md in this folder.
#pragma once
#include <chrono>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/exchange/manifest.h"
#include "common/exchange/records.h"
#include "common/result.h"

namespace ballast::exchange {

enum class Role : std::uint32_t { kFluid = 0, kRigid = 1, kCoordinator = 2 };
const char* role_name(Role role);  ///< "fluid process", "rigid process", "coordinator"

struct SegmentPlan {
  Manifest manifest;
  std::string scene_text;               ///< resolved scene, for the fluid process
  std::string out_dir;                  ///< absolute, where processes put their files
  std::uint32_t threads = 0;            ///< of the fluid; 0: all cores
  std::uint32_t monitor = 0;            ///< monitor_bit() of the frames that monitors want
  bool fluid = true, rigid = true;      ///< which processes take part
  bool named = true;                    ///< false: it loses its name at once; attach by path()
  std::uint64_t first_step = 0;         ///< the run goes on after this step, from the checkpoint in resume_dir
  std::string resume_dir;               ///< absolute; empty: from the start
  double checkpoint_every = 0;          ///< s of simulated time; 0: no checkpoints
  bool commands = false;                ///< a ring for commands from outside
  std::size_t contact_bytes = 1 << 20;  ///< ring fluid -> rigid
  std::size_t report_bytes = 8 << 20;   ///< ring of each process -> coordinator
  std::size_t final_bytes = 1 << 20;    ///< final report (JSON text) of each process
  double peer_timeout = 30;             ///< s without a sign of life before a peer counts as hung
};

/// One mapped segment. The creator (coordinator) removes it in its destructor; others only unmap.
class Segment {
 public:
  /// Creates "/dev/shm/<name>", mode 0600, O_EXCL. Names: make_name(). Error 5 when /dev/shm is full or the name is
  /// taken.
  static Result<Segment> create(const std::string& name, const SegmentPlan& plan);
  /// Maps an existing segment after checking owner, mode, magic, version, layout hash and size; registers this process
  /// (pid and start time) in its role; refuses a role that is taken or not part of the run. `name` may be a path().
  static Result<Segment> attach(const std::string& name, Role role);
  static std::string make_name();  ///< "ballast-<uid>-<pid>-<random>"
  static void remove(const std::string& name);
  /// Removes segments of this user whose coordinator is dead; returns their names.
  static std::vector<std::string> remove_stale();
  Segment(Segment&&) noexcept;
  Segment& operator=(Segment&&) noexcept;
  ~Segment();

  const std::string& name() const;
  /// What to give to attach(): the name, or where it has none, /proc/<pid>/fd/<number> of the coordinator, which lasts
  /// as long as the coordinator and this object.
  const std::string& path() const;
  /// Removes the name once nobody needs it any more: all have attached.
  void forget_name();
  ManifestView manifest() const;
  std::string_view scene_text() const;
  std::string out_dir() const;
  std::uint32_t threads() const;
  std::uint64_t first_step() const;  ///< 0, or the step of the checkpoint that the run goes on from
  std::string resume_dir() const;    ///< folder of that checkpoint; empty: from the start
  double checkpoint_every() const;   ///< s of simulated time; 0: no checkpoints
  bool has(Role role) const;         ///< fluid, rigid: takes part in this run
  bool wants(FrameKind kind) const;  ///< somebody wants these frames for monitors
  std::size_t bytes() const;

  struct Impl;
  Impl& impl() { return *impl_; }

 private:
  explicit Segment(std::unique_ptr<Impl> impl);
  template <class Object>
  static Result<Segment> map_and_claim(const std::string& name, Role role, const Object& object);
  std::unique_ptr<Impl> impl_;
};

/// What both physics processes do besides exchanging: credit, reports, end.
class Link {
 public:
  Link(Segment& segment, Role self);
  ~Link();
  /// Blocks until the coordinator has granted this step. False: it asked for the run to end here (stop).
  Result<bool> await_credit(std::uint64_t step);
  /// Step report and rows for the coordinator; blocks while the ring is full (backpressure, counted).
  Status report(const StepReport& report);
  Status frame(FrameKind kind, std::uint64_t step, double time, std::span<const double> values);
  Status warning(std::uint64_t step, double time, std::string_view text);
  /// Commands that take effect at the end of this step, kMostCommands at most: for the process that begins steps, once
  /// per step. One look at a counter where there are none, nothing at all in a run that takes none.
  Result<std::vector<Command>> commands(std::uint64_t step);
  /// What became of a command; `reason` empty: it took effect at the end of this step.
  Status command_result(std::uint64_t step, double time, std::uint64_t id, std::string_view reason);
  /// The process's part of the checkpoint after this step is written.
  Status checkpoint(std::uint64_t step, double time, const CheckpointPart& part);
  /// A frame for monitors. Never waits: while the ring is half full it is dropped and counted, so that monitors leave
  /// reports and rows the other half.
  void offer(FrameKind kind, std::uint64_t step, double time, std::span<const std::byte> payload);
  /// Hands over the final report (JSON text); with exit_code kFine, or the error's.
  Status finish(int exit_code, std::string_view json);
  /// A sign of life from within a long computation; every other call gives one too.
  void beat();
  double seconds_waited() const;          ///< total time spent in waits
  std::uint64_t waits() const;            ///< number of waits that had to sleep
  std::uint64_t late_wakes() const;       ///< waits that slept a whole slice though the news was there: lost wake-ups
  std::uint64_t blocked_reports() const;  ///< reports that had to wait for room in the ring
  std::uint64_t dropped_frames() const;   ///< frames for monitors that found no room

 protected:
  Segment& segment_;
  Role self_;
  struct Waiting;
  std::unique_ptr<Waiting> waiting_;
};

/// Fluid side of the lockstep: receive(first_step), then for each step: send(order), receive(order).
class FluidLink : public Link {
 public:
  explicit FluidLink(Segment& segment);
  /// Posts the order with its wrenches (one per body) and contacts. A full contact ring: patches merged per body,
  /// counted.
  Status send(Order order, std::span<const Wrench> wrenches, std::span<const Contact> contacts,
              std::span<const Command> commands = {});
  /// Waits for the answer to (step, iteration) and copies the states. Checks step, counts, finite numbers, unit
  /// quaternions; and after an order with kAsleep and without commands that `states` are those received last.
  Result<Answer> receive(std::uint64_t step, std::uint32_t iteration, std::span<BodyState> states);
  std::uint64_t contacts_merged() const;  ///< patches that disappeared in others so far, since the ring was full
};

/// Rigid side: send(answer first_step), then for each step: receive(order), send(answer).
class RigidLink : public Link {
 public:
  explicit RigidLink(Segment& segment);
  /// Waits for the next order; checks that step and iteration follow, dt > 0, counts, finite numbers.
  /// An order with kEnd is the end of the run after its `step` (the fluid process was stopped and finished): no answer.
  Result<Order> receive(std::span<Wrench> wrenches, std::vector<Contact>& contacts);
  Status send(Answer answer, std::span<const BodyState> states);
  /// Those of the order received last.
  std::span<const Command> ordered_commands() const;
};

/// The coordinator's side.
struct Frame {
  FrameHead head;
  std::vector<std::byte> payload;
  std::span<const double> values() const;  ///< kBodies, kProbes
  StepReport step_report() const;          ///< kStep
  std::string text() const;                ///< kWarning
  FluidStatistics fluid() const;           ///< kFluid
  CheckpointPart checkpoint() const;       ///< kCheckpoint
  CommandResult command() const;           ///< kCommand
  std::string reason() const;              ///< kCommand: why it was refused
  std::vector<Contact> contacts() const;   ///< kContacts
  ParticleSetHead particle_head() const;   ///< kParticles
  std::vector<ParticleSample> particles() const;
};
enum class PeerState { kAbsent, kRunning, kFinished, kDead };
class Control {
 public:
  explicit Control(Segment& segment);
  void grant(std::uint64_t step);  ///< both may run steps up to and including this one
  /// Hands a command to the process that begins steps; false: no room, or a run without commands.
  bool send(const Command& command);
  void stop();  ///< end before the next step that both have not begun
  /// Takes all frames waiting from a process, in order. Checks sizes and kinds.
  Status drain(Role role, std::vector<Frame>& out);
  /// Sleeps until a process has posted something, or for the time given.
  void wait_for_news(std::chrono::milliseconds at_most);
  std::uint64_t heartbeat(Role role) const;   ///< changes while the process lives and is not stopped
  PeerState state(Role role) const;           ///< kDead: process gone without finish()
  int exit_code(Role role) const;             ///< after kFinished
  std::string final_report(Role role) const;  ///< JSON text after kFinished
  int pid(Role role) const;                   ///< 0 before it attached

 private:
  Segment& segment_;
};

}  // namespace ballast::exchange
