// One loop around lcm_handle_timeout.
#include "monitor/listen.h"

#include <signal.h>

#include <chrono>
#include <csignal>
#include <lcm/lcm-cpp.hpp>

#include "msgs/url.h"

namespace ballast::monitor {

namespace {

volatile std::sig_atomic_t stop_asked = 0;

struct Receiver {
  const Hear& hear;
  void take(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    hear(channel, buffer->data, buffer->data_size);
  }
};

}  // namespace

Status listen(const std::string& asked, const std::string& channels, const Hear& hear, const GoOn& go_on) {
  auto url = msgs::url_to_open(asked);
  if (!url) return url.error();
  lcm::LCM lcm(*url);
  Receiver receiver{hear};
  if (!lcm.good() || lcm.subscribe(channels, &Receiver::take, &receiver) == nullptr) {
    return Error{"LCM cannot listen at '" + *url + "'",
                 "udpm: is there a route to it? (ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo)\n"
                 "  file: is there such a log?",
                 "--lcm-url", kProcessFailed};
  }
  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  const auto start = std::chrono::steady_clock::now();
  // -1 with a file:// URL: the log has ended.
  while (stop_asked == 0 && go_on(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()) &&
         lcm.handleTimeout(100) >= 0) {
  }
  return ok();
}

}  // namespace ballast::monitor
