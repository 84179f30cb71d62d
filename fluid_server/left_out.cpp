// Counting what the fluid process left out.
#include "fluid_server/left_out.h"

#include <fmt/format.h>

namespace ballast::fluid {

namespace {

/// A row about which nobody can count time or bytes.
nlohmann::json row_of(const char* what, const std::string& why, const std::string& saved, const char* difference) {
  return {{"what", what},          {"why", why}, {"saved", saved}, {"difference", difference}, {"saved_s", nullptr},
          {"saved_bytes", nullptr}};
}

nlohmann::json skipped_searches(const SearchCounts& n, bool skip) {
  const std::uint64_t steps = n.kept + n.searched;
  if (!skip) return row_of("search for neighbours", "not left out: numerics.skip_search is false", "nothing", "none");
  if (n.kept == 0)
    return row_of("search for neighbours", fmt::format("not left out: something left its cell in all {} steps", steps),
                  "nothing", "none");
  const double each = n.kept_seconds / static_cast<double>(n.kept);
  nlohmann::json row =
      row_of("search for neighbours", fmt::format("nothing left its cell in {} of {} steps", n.kept, steps),
             fmt::format("about, by the mean step with and without: sorting, and all lists but the {:.2g} % of which a "
                         "pair may have come into or out of reach",
                         100 * static_cast<double>(n.made_again) / static_cast<double>(n.lists)),
             "none: the same lists in the same order");
  if (n.searched > 0)
    row["saved_s"] = static_cast<double>(n.kept) * (n.searched_seconds / static_cast<double>(n.searched) - each);
  return row;
}

}  // namespace

nlohmann::json left_out_rows(const WcsphFluid& fluid, bool skip_search, const std::string& no_energy_bound,
                             const Interface& interface, std::uint64_t computed) {
  nlohmann::json rows = nlohmann::json::array();
  if (!no_energy_bound.empty())
    rows.push_back(row_of("bound of the energy", no_energy_bound, "nothing to speak of",
                          "energy that the steps make goes unseen"));
  if (const IdleSamples& idle = fluid.idle_samples(); idle.samples > 0)
    rows.push_back(
        row_of("samples without fluid", "no particle within the kernel's support",
               fmt::format("sorting and sums of {:.0f} of {} samples a step",
                           static_cast<double>(idle.samples) / static_cast<double>(idle.steps), fluid.samples().size()),
               "none: their sums would be empty"));
  if (const std::size_t fixed = fluid.samples().fixed().size(); fixed > 0)
    rows.push_back(row_of("sorting of static samples", "static bodies do not move",
                          fmt::format("placing and sorting of {} samples in each of {} steps", fixed, computed),
                          "none: they are where they were"));
  if (fluid.searches().searched + fluid.searches().kept > 0)
    rows.push_back(skipped_searches(fluid.searches(), skip_search));
  if (interface.iterates() && computed > interface.report().steps)
    rows.push_back(
        row_of("repetitions of dry steps", "no body that moves freely touched fluid",
               fmt::format("all but one exchange in {} of {} steps", computed - interface.report().steps, computed),
               "none: nothing to agree about"));
  return rows;
}

}  // namespace ballast::fluid
