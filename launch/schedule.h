// How far the two processes may run ahead of what the coordinator has seen: a pure function of step numbers.
#pragma once
#include <cstdint>
#include <optional>

namespace ballast::launch {

/// Steps that may be under way unseen. Large enough that the coordinator may sleep 50 ms at 10 us per step and nobody
/// waits for it; the report rings hold the processes back before memory could.
inline constexpr std::uint64_t kRunAhead = 8192;

/// Credit to grant next, if it is time for that: `ahead` beyond the slower process's last reported step, granted anew
/// only when half of the last credit is used, so that granting costs nothing. Never less than what was granted.
std::optional<std::uint64_t> next_credit(std::uint64_t granted, std::uint64_t reported, std::uint64_t ahead);

}  // namespace ballast::launch
