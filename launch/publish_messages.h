// From what the coordinator collects to messages; each frame becomes one message or the chunks of one.
#pragma once
#include <ballast/body_states_t.hpp>
#include <ballast/contact_sets_t.hpp>
#include <ballast/fluid_statistics_t.hpp>
#include <ballast/particles_t.hpp>
#include <ballast/status_t.hpp>
#include <ballast/warning_t.hpp>
#include <ballast/wrenches_t.hpp>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "launch/publish.h"

namespace ballast::launch {

/// What does not change through a run.
struct MessageFacts {
  std::string scene;
  double duration = 0;              ///< s
  bool fluid = false;               ///< wrenches make sense
  std::vector<std::string> bodies;  ///< names of all, as in the manifest
  std::vector<std::string> moving;  ///< names of those in kBodies frames
  static MessageFacts of(const Prepared& prepared);
};

/// Speed over the last one to two seconds of wall time.
class RealTimeFactor {
 public:
  double update(double time, double wall);

 private:
  struct Point {
    double time = 0, wall = 0;
  };
  Point before_, now_;
};

/// Most that a list message holds: with names of 64 bytes, 200 bytes a body or contact, and so under 60 KB.
inline constexpr std::size_t kListChunk = 250;
/// 32 bytes a particle: 57.6 KB and the head.
inline constexpr std::size_t kParticleChunk = 1800;

std::vector<body_states_t> body_messages(const MessageFacts& facts, const exchange::Frame& frame, std::int64_t number);
std::vector<wrenches_t> wrench_messages(const MessageFacts& facts, const exchange::Frame& frame, std::int64_t number);
std::vector<contact_sets_t> contact_messages(const MessageFacts& facts, const exchange::Frame& frame,
                                             std::int64_t number);
std::vector<particles_t> particle_messages(const exchange::Frame& frame, std::int64_t number);
fluid_statistics_t fluid_message(const exchange::Frame& frame);
warning_t warning_message(exchange::Role role, const exchange::Frame& frame);
/// Without utime, sent and dropped, which the sender knows.
status_t status_message(const MessageFacts& facts, const RunStatus& status, const std::string& limit,
                        RealTimeFactor& speed);

}  // namespace ballast::launch
