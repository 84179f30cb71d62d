// Byte layout of the shared segment's header: identity, block table, and one 128-byte line per writer.
// README.md prints every offset; a test compares the two.
#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "common/exchange/link.h"
#include "common/exchange/records.h"

namespace ballast::exchange {

// Lock-free atomics hold no hidden state, so they work between processes at different addresses.
using Word = std::atomic<std::uint32_t>;
using Wide = std::atomic<std::uint64_t>;
static_assert(Word::is_always_lock_free && sizeof(Word) == 4 && alignof(Word) == 4);
static_assert(Wide::is_always_lock_free && sizeof(Wide) == 8 && alignof(Wide) == 8);

/// Two cache lines: the prefetcher of common processors fetches lines in pairs.
inline constexpr std::size_t kLine = 128;
inline constexpr std::size_t kHeaderBytes = 4096;
inline constexpr std::uint64_t kClosed = 1ULL << 63;  ///< bit of Header::gate: no new step may begin

/// Where one part of the segment lies; offset from the segment's start, a multiple of kLine.
struct Block {
  std::uint64_t offset, bytes;
};
enum class Part : std::uint32_t {
  kWorld,
  kBodies,
  kShapes,
  kJoints,
  kVertices,
  kTriangles,  // manifest
  kSceneText,
  kOutDir,
  kOrder,
  kAnswer,  // payload of the mailboxes
  kContacts,
  kFluidReports,
  kRigidReports,  // bytes of the rings
  kFluidFinal,
  kRigidFinal,
  kResumeDir,
  kCommands,
  kCount
};
inline constexpr std::size_t kParts = static_cast<std::size_t>(Part::kCount);

enum class Attendance : std::uint32_t { kAbsent = 0, kRunning = 1, kFinished = 2 };

/// One process; written by that process alone.
struct alignas(kLine) PeerLine {
  Word pid;          ///< 0 until the process has claimed the role (compare-and-swap from 0)
  Word state;        ///< Attendance
  Wide start_time;   ///< field 22 of /proc/<pid>/stat: tells a process from a later one with the same pid
  Wide heartbeat;    ///< counts calls; a waiting process counts once per slice
  Wide step;         ///< the step begun last, for messages
  Word exit_code;    ///< valid when finished
  Word sleeping;     ///< 1 while this process may sleep on a futex; nobody else ever writes it
  Wide final_bytes;  ///< length of the final report, valid when finished
};
static_assert(sizeof(PeerLine) == kLine);

/// A message slot: `sequence` counts messages and is the futex word; its payload lies in a block of its own.
struct alignas(kLine) Mailbox {
  Word sequence;
};
static_assert(sizeof(Mailbox) == kLine);

/// Counters of a byte ring, modulo 2^32; the capacity is a power of two, the byte of counter c lies at c mod capacity.
struct RingCounters {
  alignas(kLine) Word head;  ///< bytes ever written, by the writer
  alignas(kLine) Word tail;  ///< bytes ever read, by the reader; futex word of a writer that waits for room
};
static_assert(sizeof(RingCounters) == 2 * kLine);

struct alignas(kLine) Header {
  // Identity. The first 64 bytes keep their meaning in every version, so that old segments can be recognised and
  // removed.
  Wide magic;  ///< stored last by the creator
  std::uint32_t version, header_bytes;
  std::uint64_t layout_hash, segment_bytes;
  std::uint32_t coordinator_pid, owner_uid;
  std::uint64_t coordinator_start, run_id;
  double peer_timeout;  ///< s
  std::uint32_t fluid_takes_part, rigid_takes_part, threads;
  std::uint32_t monitor;     ///< monitor_bit() of each kind of frame that somebody wants
  std::uint64_t first_step;  ///< the run goes on after this step: 0, or that of the checkpoint in part kResumeDir
  double checkpoint_every;   ///< s of simulated time between checkpoints; 0: none
  alignas(kLine) Block parts[kParts];
  PeerLine peers[3];  ///< indexed by Role
  Mailbox order, answer;
  RingCounters contacts, fluid_reports, rigid_reports, commands;
  alignas(kLine) Wide granted;  ///< coordinator: steps up to and including this one may begin
  Word credit;                  ///< coordinator: futex word, counts grants and stops
  alignas(kLine) Wide gate;     ///< any: highest step begun by a process; bit 63 (kClosed) set by the coordinator
  alignas(kLine) Word news;     ///< fluid and rigid: futex word of the coordinator, counts what was posted to it
};
static_assert(sizeof(Header) <= kHeaderBytes);

/// One field of the layout, for the hash and for the protocol page.
struct LayoutField {
  std::string_view record, field;
  std::size_t offset, bytes;
};
std::span<const LayoutField> layout_fields();
/// FNV-1a over the protocol version and every field's offset and size.
std::uint64_t layout_hash();

}  // namespace ballast::exchange
