// "Did you mean ...": the known name nearest to what was written.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace ballast::scene {

/// Insertions, deletions, replacements and swaps of neighbours that lead from a to b (optimal string alignment).
int edit_distance(std::string_view a, std::string_view b);

/// "Did you mean 'x'? Known here: x, y, z." or only the second sentence where nothing is near.
std::string suggestion(std::string_view written, const std::vector<std::string>& known);

}  // namespace ballast::scene
