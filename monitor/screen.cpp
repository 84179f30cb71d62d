// Messages in, lines out; no terminal in here.
#include "monitor/screen.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "monitor/message_type.h"
#include "msgs/channels.h"

namespace ballast::monitor {

namespace {

double length(const double (&v)[3]) { return std::hypot(v[0], v[1], v[2]); }

/// Cuts at 80 columns; names and warnings may hold anything, so control characters become blanks.
std::string fitted(std::string text) {
  for (char& c : text) c = static_cast<unsigned char>(c) < 32 || c == 127 ? ' ' : c;
  std::size_t columns = 0, at = 0;
  for (; at < text.size(); ++at) {
    if ((static_cast<unsigned char>(text[at]) & 0xc0) == 0x80) continue;  // inside a UTF-8 character
    if (columns == kColumns) break;
    ++columns;
  }
  return text.substr(0, at);
}

std::string bar(double share, std::size_t width) {
  const double filled = std::clamp(share, 0.0, 1.0) * static_cast<double>(width);
  const auto full = static_cast<std::size_t>(std::lround(filled));
  return std::string(full, '#') + std::string(width - full, '.');
}

std::string share_text(double part, double whole) {
  return whole > 0 ? fmt::format("{:.0f} %", 100 * part / whole) : "-";
}

std::string process_text(const char* name, int pid, const std::string& state) {
  return state == "none" ? fmt::format("no {} process", name) : fmt::format("{} {} (pid {})", name, state, pid);
}

/// Mass and momentum that are missing, energy that nobody gave; NaN: the run has no such balance.
std::string balance_text(const status_t& s) {
  std::string text;
  const auto add = [&](double value, const std::string& figure) {
    if (!std::isnan(value)) text += (text.empty() ? "" : "; ") + figure;
  };
  add(s.mass_drift, fmt::format("mass {:.3g} %", 100 * s.mass_drift));
  add(s.momentum_imbalance, fmt::format("momentum {:.1g}", s.momentum_imbalance));  // rounding errors, or a defect
  add(s.energy_gain, fmt::format("energy gained {:.3g} %", 100 * s.energy_gain));
  return text;
}

}  // namespace

template <class Message>
std::optional<Message> View::decoded(const void* data, std::size_t bytes) {
  Message message;
  const ballast_message_type_t* type = type_of(data, bytes);  // the generated decoder checks the hash
  if (type && bytes <= std::numeric_limits<int>::max() && fits(*type->info, data, bytes) &&
      message.decode(data, 0, static_cast<int>(bytes)) >= 0)
    return message;
  ++undecodable_;
  return std::nullopt;
}

void View::take(const std::string& channel, const void* data, std::size_t bytes) {
  if (channel == msgs::kStatus) {
    if (auto m = decoded<status_t>(data, bytes)) take_status(std::move(*m));
  } else if (channel == msgs::kFluid) {
    if (auto m = decoded<fluid_statistics_t>(data, bytes)) fluid_ = std::move(m);
  } else if (channel == msgs::kBodies) {
    if (auto m = decoded<body_states_t>(data, bytes)) take_bodies(*m);
  } else if (channel == msgs::kWrenches) {
    if (auto m = decoded<wrenches_t>(data, bytes)) {
      for (wrench_t& w : m->wrenches) wrenches_[w.body] = std::move(w);
    }
  } else if (channel == msgs::kContacts) {
    if (auto m = decoded<contact_sets_t>(data, bytes)) {
      patches_coming_ = (m->chunk == 0 ? 0 : patches_coming_) + m->contacts.size();
      if (std::int64_t{m->chunk} + 1 == m->chunks) patches_ = patches_coming_;
    }
  } else if (channel == msgs::kParticles) {
    if (auto m = decoded<particles_t>(data, bytes)) particles_ = std::move(m);
  } else if (channel == msgs::kWarning) {
    if (auto m = decoded<warning_t>(data, bytes)) warnings_.push_back(std::move(*m));
  }
}

void View::take_status(status_t&& message) {
  // Another run, perhaps of another scene: what was heard of the one before says nothing about it.
  if (status_ && (message.scene != status_->scene || message.step < status_->step)) {
    const std::size_t undecodable = undecodable_;
    *this = View();
    undecodable_ = undecodable;
  }
  status_ = std::move(message);
}

void View::take_bodies(const body_states_t& message) {
  for (const body_state_t& state : message.bodies) {
    const auto known = std::ranges::find_if(bodies_, [&](const Row& r) { return r.state.name == state.name; });
    if (known == bodies_.end()) {
      bodies_.push_back({state});
    } else {
      known->state = state;
    }
  }
}

std::string View::head_line(double silent) const {
  std::string state = status_->state;
  if (ended()) {
    state += fmt::format(", exit code {}", status_->exit_code);
  } else if (silent > 2) {
    state += fmt::format(", SILENT for {:.0f} s", silent);
  }
  return fmt::format("Ballast  {}: {}", status_->scene, state);
}

void View::run_lines(std::vector<std::string>& out) const {
  const status_t& s = *status_;
  const double done = s.duration > 0 ? s.time / s.duration : 1;
  out.push_back(
      fmt::format("time       {:.4f} of {:g} s  [{}] {:.1f} %", s.time, s.duration, bar(done, 30), 100 * done));
  std::string speed = fmt::format("speed      {:.3g} x real time (mean {:.3g}), {:.1f} s so far", s.real_time_factor,
                                  s.real_time_factor_mean, s.wall);
  if (done > 0.02 && done < 1 && !ended()) speed += fmt::format(", {:.0f} s left", s.wall * (1 - done) / done);
  out.push_back(speed);
  if (s.step == 0) {
    out.push_back("step       none yet: the processes are setting up");
    return;
  }
  const std::string why = s.step_limit == "asleep" ? "asleep: all is at rest" : "limited by " + s.step_limit;
  out.push_back(fmt::format("step       {} of {:.4g} ms, {}", s.step, 1e3 * s.dt, why));
}

void View::process_lines(std::vector<std::string>& out) const {
  const status_t& s = *status_;
  out.push_back("processes  " + process_text("fluid", s.fluid_pid, s.fluid_state) + ", " +
                process_text("rigid", s.rigid_pid, s.rigid_state));
  std::string work = "work      ";
  for (const auto& [name, state, compute, wait] : {std::tuple{"fluid", s.fluid_state, s.fluid_compute, s.fluid_wait},
                                                   std::tuple{"rigid", s.rigid_state, s.rigid_compute, s.rigid_wait}}) {
    if (state == "none") continue;
    work += fmt::format(" {} computes {}, waits {};", name, share_text(compute, compute + wait),
                        share_text(wait, compute + wait));
  }
  work.pop_back();
  out.push_back(work);
}

void View::fluid_lines(std::vector<std::string>& out) const {
  const status_t& s = *status_;
  if (s.fluid_state == "none") {
    out.push_back("fluid      none in this scene");
    return;
  }
  if (fluid_) {
    const fluid_statistics_t& f = *fluid_;
    const double sum = f.sort_time + f.pressure_time + f.boundary_time + f.motion_time + f.wait_time;
    out.push_back(fmt::format("stages     sort {}, pressure {}, boundary {}, motion {}, waiting {}",
                              share_text(f.sort_time, sum), share_text(f.pressure_time, sum),
                              share_text(f.boundary_time, sum), share_text(f.motion_time, sum),
                              share_text(f.wait_time, sum)));
  }
  std::string error = fmt::format("error      density {:.3g} % in the mean, {:.3g} % at worst",
                                  100 * s.density_error_mean, 100 * s.density_error_max);
  if (s.pressure_residual > 0) error += fmt::format("; pressure {:.3g} %", 100 * s.pressure_residual);
  // free bodies have a rounding error
  if (s.interface_residual > 1e-9) error += fmt::format("; interface {:.3g} %", 100 * s.interface_residual);
  out.push_back(error);
  if (const std::string balance = balance_text(s); !balance.empty()) out.push_back("balance    " + balance);
  if (fluid_) {
    const fluid_statistics_t& f = *fluid_;
    out.push_back(fmt::format("fluid      {} particles, {} lost; fastest {:.3g} m/s, sound {:.3g} m/s", f.particles,
                              f.lost, f.max_speed, f.sound_speed));
    out.push_back(fmt::format("energy     kinetic {:.4g} J, potential {:.4g} J, elastic {:.4g} J", f.kinetic,
                              f.potential, f.elastic));
  } else {
    out.push_back(fmt::format("fluid      {} particles", s.particles));
  }
}

void View::body_lines(std::vector<std::string>& out, std::size_t room) const {
  if (bodies_.empty() || room < 2) return;
  out.push_back(fmt::format("{:<18}{:>10}{:>10}{:>10}{:>10}{:>11}{:>11}", "body", "x [m]", "y [m]", "z [m]", "v [m/s]",
                            "force [N]", "torque[Nm]"));
  const std::size_t shown = bodies_.size() < room ? bodies_.size() : room - 2;
  for (std::size_t i = 0; i < shown; ++i) {
    const body_state_t& b = bodies_[i].state;
    const auto w = wrenches_.find(b.name);
    const auto size = [&](auto member) {
      return w == wrenches_.end() ? std::string("-") : fmt::format("{:.4g}", length(w->second.*member));
    };
    out.push_back(fmt::format("{:<18.18}{:>10.4f}{:>10.4f}{:>10.4f}{:>10.4f}{:>11}{:>11}", b.name, b.position[0],
                              b.position[1], b.position[2], length(b.velocity), size(&wrench_t::force),
                              size(&wrench_t::torque)));
  }
  if (shown < bodies_.size()) out.push_back(fmt::format("... and {} more", bodies_.size() - shown));
}

std::vector<std::string> View::warning_lines() const {
  std::vector<std::string> out;
  const auto count = std::max<std::size_t>(warnings_.size(), static_cast<std::size_t>(std::max(0, status_->warnings)));
  if (count == 0) return {"warnings   none"};
  out.push_back(fmt::format("warnings   {}{}", count, warnings_.empty() ? " before this monitor came" : ", the last:"));
  if (warnings_.empty()) return out;
  const std::string& text = warnings_.back().text;
  const std::size_t end = text.size() <= kColumns - 2 ? std::string::npos : text.rfind(' ', kColumns - 2);
  out.push_back("  " + text.substr(0, end));
  if (end != std::string::npos) out.push_back("  " + text.substr(end + 1));
  return out;
}

std::vector<std::string> View::lines(double silent) const {
  if (!status_) return {"Ballast  no run is sending messages (ballast run SCENE --lcm)"};
  std::vector<std::string> out = {head_line(silent)};
  run_lines(out);
  process_lines(out);
  fluid_lines(out);
  std::string messages = fmt::format("messages   {} sent, {} dropped", status_->sent, status_->dropped);
  if (undecodable_ > 0) messages += fmt::format(", {} NOT DECODABLE: another build?", undecodable_);
  if (patches_ > 0) messages += fmt::format("; {} contact patches", patches_);
  if (particles_) messages += fmt::format("; {} of {} particles", particles_->shown, particles_->particles);
  out.push_back(messages);
  const std::vector<std::string> warnings = warning_lines();
  body_lines(out, kLines - out.size() - warnings.size());
  out.insert(out.end(), warnings.begin(), warnings.end());
  for (std::string& line : out) line = fitted(std::move(line));
  return out;
}

}  // namespace ballast::monitor
