// Credit as a pure function of step numbers.
#include "launch/schedule.h"

namespace ballast::launch {

std::optional<std::uint64_t> next_credit(std::uint64_t granted, std::uint64_t reported, std::uint64_t ahead) {
  const std::uint64_t wanted = reported + (ahead > 0 ? ahead : 1);
  if (wanted <= granted) return std::nullopt;
  if (granted > reported && wanted - granted < ahead / 2) return std::nullopt;
  return wanted;
}

}  // namespace ballast::launch
