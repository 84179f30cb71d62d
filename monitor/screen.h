// What `ballast watch` shows: the last message of each kind, as at most 24 lines of 80 columns.
#pragma once
#include <ballast/body_states_t.hpp>
#include <ballast/contact_sets_t.hpp>
#include <ballast/fluid_statistics_t.hpp>
#include <ballast/particles_t.hpp>
#include <ballast/status_t.hpp>
#include <ballast/warning_t.hpp>
#include <ballast/wrenches_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace ballast::monitor {

inline constexpr std::size_t kLines = 24, kColumns = 80;

/// The last of everything that has come.
class View {
 public:
  /// Takes in a message of any channel of Ballast; what cannot be decoded is counted.
  void take(const std::string& channel, const void* data, std::size_t bytes);
  bool has_status() const { return status_.has_value(); }
  bool ended() const { return status_ && (status_->state == "finished" || status_->state == "failed"); }
  /// The screen; `silent` is how long nothing has come, in s.
  std::vector<std::string> lines(double silent) const;

 private:
  struct Row {
    body_state_t state;
    double force = 0, torque = 0;  // N, N m
  };
  template <class Message>
  std::optional<Message> decoded(const void* data, std::size_t bytes);
  void take_status(status_t&& message);
  void take_bodies(const body_states_t& message);
  std::string head_line(double silent) const;
  void run_lines(std::vector<std::string>& out) const;
  void process_lines(std::vector<std::string>& out) const;
  void fluid_lines(std::vector<std::string>& out) const;
  void body_lines(std::vector<std::string>& out, std::size_t room) const;
  std::vector<std::string> warning_lines() const;

  std::optional<status_t> status_;
  std::optional<fluid_statistics_t> fluid_;
  std::vector<Row> bodies_;
  std::map<std::string, wrench_t> wrenches_;
  std::size_t patches_ = 0, patches_coming_ = 0;
  std::optional<particles_t> particles_;
  std::vector<warning_t> warnings_;
  std::size_t undecodable_ = 0;
};

}  // namespace ballast::monitor
