// Nearest name by edit distance.
#include "common/scene/nearest.h"

#include <fmt/format.h>

#include <algorithm>

namespace ballast::scene {

int edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<int>> d(a.size() + 1, std::vector<int>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i) {
    for (size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = static_cast<int>(i + j);
        continue;
      }
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

std::string suggestion(std::string_view written, const std::vector<std::string>& known) {
  constexpr size_t kShown = 20, kCompared = 5000;  // a scene can have thousands of models
  if (known.empty()) return "Nothing can be named here.";
  const std::string_view start = written.substr(0, 64);  // longer names are nobody's typing error
  const auto end = known.begin() + static_cast<long>(std::min(known.size(), kCompared));
  const auto nearest = std::min_element(known.begin(), end, [&](const auto& x, const auto& y) {
    return edit_distance(start, x) < edit_distance(start, y);
  });
  const int limit = std::max(1, static_cast<int>(std::max(start.size(), nearest->size())) / 3);
  std::string text;
  if (edit_distance(start, *nearest) <= limit) text = fmt::format("Did you mean '{}'? ", *nearest);
  std::vector<std::string> shown(known.begin(), known.begin() + static_cast<long>(std::min(known.size(), kShown)));
  if (known.size() > kShown) shown.push_back("...");
  return text + fmt::format("Known here: {}.", fmt::join(shown, ", "));
}

}  // namespace ballast::scene
