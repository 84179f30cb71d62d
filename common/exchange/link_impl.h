// What a Link keeps between calls; shared by the files of this folder only.
#pragma once
#include "common/exchange/checks.h"
#include "common/exchange/ring.h"
#include "common/exchange/wait.h"

namespace ballast::exchange {

struct Link::Waiting {
  Waiting(Segment::Impl& segment, Role self);

  /// Copies a frame into the report ring, sleeping while it has no room.
  Status write_frame(const FrameHead& head, std::span<const std::byte> payload);
  /// The copying of it, where there is room.
  void put_frame(const FrameHead& head, std::span<const std::byte> payload);
  /// Posts what was written to this mailbox's payload, and wakes its reader.
  void post(Mailbox& mailbox, Role reader);
  /// Waits until the peer has posted message number received + 1.
  Result<Waiter::End> await_message(const Mailbox& mailbox, Role peer);
  Expected expected(Role sender) const;
  void tell_coordinator();

  Segment::Impl& segment;
  Role self;
  Waiter waiter;
  Ring reports, contacts;
  std::uint64_t blocked = 0, dropped = 0;
  std::uint32_t posted = 0, received = 0;  ///< messages; the protocol is strictly alternating
  std::uint64_t step = 0;                  ///< of the last message sent or received
  std::uint32_t iteration = 0;
  std::uint64_t contacts_merged = 0;
  bool asleep = false;  ///< fluid: bodies may not move in the order sent last
  Ring command_ring;
  std::vector<Command> commands;  ///< begins steps: waiting; rigid: of the last order
  std::vector<Contact> merged;    ///< one patch per body, for a full contact ring
};

inline Error misuse(const std::string& what) {
  return {what, "this is a bug in the calling program", "", kProcessFailed};
}

}  // namespace ballast::exchange
