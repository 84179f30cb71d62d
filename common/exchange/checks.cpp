// Checks of messages. All work on private copies, so a sender cannot change a value after it was checked.
#include "common/exchange/checks.h"

#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace ballast::exchange {
namespace {

constexpr double kUnitTolerance = 1e-4;  // single-precision engines normalise to 1e-7; more is not a rotation

struct NumberField {
  const char* name;
  std::size_t offset, count;  // in doubles
};
#define FIELD(record, field) \
  NumberField { #field, offsetof(record, field) / 8, sizeof(record::field) / 8 }
constexpr NumberField kStateFields[] = {FIELD(BodyState, position),     FIELD(BodyState, orientation),
                                        FIELD(BodyState, velocity),     FIELD(BodyState, angular_velocity),
                                        FIELD(BodyState, acceleration), FIELD(BodyState, free_acceleration),
                                        FIELD(BodyState, mobility)};
constexpr NumberField kWrenchFields[] = {FIELD(Wrench, force), FIELD(Wrench, torque)};
constexpr NumberField kContactFields[] = {FIELD(Contact, position), FIELD(Contact, normal), FIELD(Contact, force),
                                          FIELD(Contact, depth), FIELD(Contact, area)};
#undef FIELD

std::string shown_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// True if no double of the record is infinite or NaN: their exponent is all ones, so adding one to it sets the top
/// bit. Integers, because the compiler may run them several at a time; a state has 61 doubles and is on the step's
/// path.
template <class Record>
bool all_finite(std::span<const Record> records, std::size_t first_double) {
  constexpr std::size_t kCount = sizeof(Record) / 8;
  std::uint64_t found = 0;
  for (const Record& record : records) {
    std::uint64_t bits[kCount];
    std::memcpy(bits, &record, sizeof bits);
    for (std::size_t i = first_double; i < kCount; ++i) {
      found |= (bits[i] & 0x7ff0000000000000ULL) + 0x0010000000000000ULL;
    }
  }
  return (found >> 63) == 0;
}

std::string body_name(const ManifestView& m, std::size_t body) {
  const std::string index = std::to_string(body);
  return body < m.bodies.size() ? "body " + index + " (" + m.bodies[body].name + ")" : "body " + index;
}

template <class Record, std::size_t N>
Error first_bad_number(std::span<const Record> records, const NumberField (&fields)[N], const Expected& expected,
                       const ManifestView& m, auto body_of) {
  for (std::size_t r = 0; r < records.size(); ++r) {
    double values[sizeof(Record) / 8];
    std::memcpy(values, &records[r], sizeof values);
    for (const NumberField& f : fields) {
      for (std::size_t i = 0; i < f.count; ++i) {
        const double v = values[f.offset + i];
        if (std::isfinite(v)) continue;
        const std::string index = f.count > 1 ? "[" + std::to_string(i) + "]" : "";
        return bad_field(expected, f.name + index + " of " + body_name(m, body_of(r)), shown_number(v),
                         "a finite number");
      }
    }
  }
  return bad_field(expected, "a record", "not finite", "finite numbers");
}

/// Bounds on the next step: 0 and +inf mean that the sender knows none.
bool good_bound(double v) { return v >= 0; }

template <class T>
Error mismatch(const Expected& e, const char* field, T seen, T wanted) {
  return bad_field(e, field, std::to_string(seen), std::to_string(wanted));
}

}  // namespace

Error bad_field(const Expected& e, const std::string& field, const std::string& seen, const std::string& wanted) {
  return {std::string("the ") + e.sender + " (pid " + std::to_string(e.pid) + ") sent " + field + " = " + seen +
              ", expected " + wanted + "; the last step exchanged was " + std::to_string(e.step) + " (iteration " +
              std::to_string(e.iteration) + ")",
          "that process has diverged or does not follow common/exchange/README.md", "", kProcessFailed};
}

Status check_order(const Order& o, const Expected& e, const ManifestView& m) {
  const bool again = o.iteration != 0;
  if (o.flags & ~(kLast | kRollBack | kAsleep))
    return bad_field(e, "flags", std::to_string(o.flags), "a sum of 1, 2 and 8");
  if (again != ((o.flags & kRollBack) != 0)) {
    return bad_field(e, "flags", std::to_string(o.flags), again ? "kRollBack in a repetition" : "no kRollBack");
  }
  if (again && e.step == 0) return mismatch(e, "iteration", o.iteration, 0u);
  const std::uint64_t step = again ? e.step : e.step + 1;
  if (o.step != step) return mismatch(e, "step", o.step, step);
  if (again && o.iteration != e.iteration + 1) return mismatch(e, "iteration", o.iteration, e.iteration + 1);
  if (!std::isfinite(o.time)) return bad_field(e, "time", shown_number(o.time), "a finite number");
  if (!(std::isfinite(o.dt) && o.dt > 0)) return bad_field(e, "dt", shown_number(o.dt), "a positive number");
  if (!good_bound(o.next_dt)) return bad_field(e, "next_dt", shown_number(o.next_dt), "a bound, or 0 for none");
  const auto n = static_cast<std::uint32_t>(m.bodies.size());
  if (o.bodies != n) return mismatch(e, "bodies", o.bodies, n);
  if (o.commands > kMostCommands)
    return bad_field(e, "commands", std::to_string(o.commands), "at most " + std::to_string(kMostCommands));
  return ok();
}

Status check_command(const Command& c, const Expected& e, const ManifestView& m) {
  const auto kind = static_cast<std::uint32_t>(c.kind);
  if (kind < 1 || kind > 3) return bad_field(e, "kind of a command", std::to_string(kind), "1, 2 or 3");
  if (c.kind != CommandKind::kGravity && c.body >= m.bodies.size())
    return bad_field(e, "body of a command", std::to_string(c.body),
                     "an index below " + std::to_string(m.bodies.size()));
  for (const double v : c.values)
    if (!std::isfinite(v)) return bad_field(e, "values of a command", shown_number(v), "a finite number");
  if (!std::isfinite(c.duration))
    return bad_field(e, "duration of a command", shown_number(c.duration), "a finite number");
  return ok();
}

Status check_answer(const Answer& a, const Expected& e, const ManifestView& m) {
  if (a.step != e.step) return mismatch(e, "step", a.step, e.step);
  if (a.iteration != e.iteration) return mismatch(e, "iteration", a.iteration, e.iteration);
  const auto n = static_cast<std::uint32_t>(m.bodies.size());
  if (a.bodies != n) return mismatch(e, "bodies", a.bodies, n);
  if (!std::isfinite(a.time)) return bad_field(e, "time", shown_number(a.time), "a finite number");
  if (!good_bound(a.max_dt)) return bad_field(e, "max_dt", shown_number(a.max_dt), "a bound, or 0 for none");
  return ok();
}

Status check_wrenches(std::span<const Wrench> wrenches, const Expected& e, const ManifestView& m) {
  if (all_finite(wrenches, 0)) return ok();
  return first_bad_number(wrenches, kWrenchFields, e, m, [](std::size_t i) { return i; });
}

Status check_states(std::span<const BodyState> states, const Expected& e, const ManifestView& m) {
  if (!all_finite(states, 0)) {
    return first_bad_number(states, kStateFields, e, m, [](std::size_t i) { return i; });
  }
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double* q = states[i].orientation;
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (std::abs(square - 1) > 2 * kUnitTolerance) {
      return bad_field(e, "orientation of " + body_name(m, i), "length " + shown_number(std::sqrt(square)), "length 1");
    }
  }
  return ok();
}

Status check_contacts(std::span<const Contact> contacts, const Expected& e, const ManifestView& m) {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (contacts[i].body < m.bodies.size()) continue;
    return bad_field(e, "body of contact " + std::to_string(i), std::to_string(contacts[i].body),
                     "an index below " + std::to_string(m.bodies.size()));
  }
  if (all_finite(contacts, 1)) return ok();  // the first 8 bytes are two integers
  return first_bad_number(contacts, kContactFields, e, m, [&](std::size_t i) { return contacts[i].body; });
}

}  // namespace ballast::exchange
