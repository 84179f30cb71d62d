// What a message must satisfy before its reader believes it. A violation is an Error 5 that names sender, field and
// body.
#pragma once
#include <span>

#include "common/exchange/manifest.h"
#include "common/exchange/records.h"
#include "common/result.h"

namespace ballast::exchange {

/// Where the reader stands in the lockstep, and from whom the message came.
struct Expected {
  const char* sender;  ///< "rigid process"
  std::uint32_t pid;
  std::uint64_t step;       ///< orders: last step answered; answers: step ordered
  std::uint32_t iteration;  ///< of that step
};

Status check_order(const Order& order, const Expected& expected, const ManifestView& manifest);
Status check_answer(const Answer& answer, const Expected& expected, const ManifestView& manifest);
Status check_wrenches(std::span<const Wrench> wrenches, const Expected& expected, const ManifestView& manifest);
Status check_states(std::span<const BodyState> states, const Expected& expected, const ManifestView& manifest);
Status check_contacts(std::span<const Contact> contacts, const Expected& expected, const ManifestView& manifest);
Status check_command(const Command& command, const Expected& expected, const ManifestView& manifest);
/// The error of a message whose `field` has the value seen.
Error bad_field(const Expected& expected, const std::string& field, const std::string& seen, const std::string& wanted);

}  // namespace ballast::exchange
