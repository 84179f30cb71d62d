// One LCM message to ourselves, on the way that a run's messages take.
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstring>
#include <lcm/lcm-cpp.hpp>
#include <random>

#include "launch/doctor.h"
#include "msgs/url.h"

namespace ballast::launch {

namespace {

constexpr const char* kChannel = "BALLAST_DOCTOR";
constexpr auto kPatience = std::chrono::seconds(2);

/// Hears its own number again; another doctor's does not count.
struct Echo {
  std::uint64_t sent = 0;
  bool heard = false;
  void hear(const lcm::ReceiveBuffer* buffer, const std::string&) {
    heard = heard || (buffer->data_size == sizeof sent && std::memcmp(buffer->data, &sent, sizeof sent) == 0);
  }
};

}  // namespace

Result<std::string> lcm_round_trip() {
  const auto url = msgs::url_to_open("");
  if (!url) return url.error();
  const std::string version = fmt::format("LCM {}.{}.{}", LCM_MAJOR_VERSION, LCM_MINOR_VERSION, LCM_MICRO_VERSION);
  if (url->starts_with("file:"))
    return Error{version + ": LCM_DEFAULT_URL is a log (" + *url + "), which nobody can watch live",
                 "unset LCM_DEFAULT_URL, or start runs with --lcm-url", ""};
  constexpr const char* kRoute =
      "udpm: give multicast a route on this machine (ip link set lo up; ip link set lo multicast on; "
      "ip route add 224.0.0.0/4 dev lo); tcpq: start its server";
  lcm::LCM lcm(*url);
  std::random_device random;
  Echo echo{(std::uint64_t{random()} << 32) | random()};
  if (!lcm.good() || !lcm.subscribe(kChannel, &Echo::hear, &echo))
    return Error{fmt::format("{} cannot open '{}'", version, *url), kRoute, ""};
  const auto start = std::chrono::steady_clock::now();
  if (lcm.publish(kChannel, &echo.sent, sizeof echo.sent) != 0)
    return Error{fmt::format("{} cannot send to '{}'", version, *url), kRoute, ""};
  while (!echo.heard && std::chrono::steady_clock::now() < start + kPatience && lcm.handleTimeout(50) >= 0) {
  }
  if (!echo.heard) return Error{fmt::format("{}: a message to '{}' did not come back", version, *url), kRoute, ""};
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return fmt::format("{}, a message over {} came back after {:.2g} ms", version, *url, 1e3 * wall);
}

}  // namespace ballast::launch
