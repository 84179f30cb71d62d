// The road from a file to a Scene: text -> tree -> overrides -> structs -> copies -> checks.
#include "common/scene/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/scene/check.h"
#include "common/scene/nearest.h"
#include "common/scene/read_fields.h"

namespace ballast {
namespace scene {
namespace {

/// Where several of the keys in `group` are present, the one from the latest override stays.
bool decide(const std::vector<std::string>& group, const Node& map, ReadState& state,
            std::set<std::string, std::less<>>& overruled) {
  const Entry* winner = nullptr;
  for (const std::string& key : group) {
    const Entry* entry = map.find(key);
    if (entry == nullptr) continue;
    if (winner != nullptr && winner->rank == entry->rank) {
      state.fail(entry->place, fmt::format("{} and {} exclude each other", winner->key, entry->key),
                 fmt::format("Remove one of the two; the other stands at {}.", where(winner->place)));
      return false;
    }
    const Entry* loser = winner != nullptr && winner->rank > entry->rank ? entry : winner;
    if (loser != nullptr) overruled.insert(loser->key);
    if (loser != entry) winner = entry;
  }
  return true;
}

}  // namespace

bool Reader::admit(const Keys& keys) {
  if (state_.error) return false;
  for (const Entry& entry : map_.map) {
    if (std::find(keys.all.begin(), keys.all.end(), entry.key) == keys.all.end()) {
      state_.fail(entry.place, fmt::format("the key '{}' is not known here", entry.key),
                  suggestion(entry.key, keys.all));
      return false;
    }
  }
  for (const auto& pair : keys.pairs) {
    if (!decide(pair, map_, state_, overruled_)) return false;
  }
  if (!decide(keys.options, map_, state_, overruled_)) return false;
  const bool chosen =
      std::any_of(keys.options.begin(), keys.options.end(), [&](const auto& key) { return map_.find(key); });
  if (!keys.needed.empty() && !chosen) {
    state_.fail(map_.place, fmt::format("nothing here says {}", keys.needed),
                fmt::format("Add one of: {}.", fmt::join(keys.options, ", ")));
  }
  return !state_.error;
}

const Entry* Reader::take(std::string_view key) {
  const Entry* entry = overruled_.contains(key) ? nullptr : map_.find(key);
  if (entry != nullptr) state_.places[{where(map_.place), entry->key}] = entry->value.place;
  return entry;
}

void Reader::missing(const Field& field) {
  state_.fail(
      map_.place, fmt::format("the key '{}' is missing", field.name),
      field.help.empty() ? fmt::format("Add {}.", field.name) : fmt::format("Add {}: {}.", field.name, field.help));
}

void Reader::refuse(const std::string& key, std::string_view whose) {
  const Entry* entry = take(key);
  if (entry == nullptr) return;
  state_.fail(entry->place, fmt::format("{} has no effect here: it is only for {}", key, whose),
              fmt::format("Remove {}.", key));
}

}  // namespace scene

Result<Scene> read_scene_text(const std::string& text, const std::string& file, const Overrides& overrides) {
  auto root = scene::parse_yaml(text, file);
  if (!root) return root.error();
  if (root->kind != scene::Node::Kind::kMap) {
    return scene::error_at(root->place, "a scene is a map of keys, but this is not one", "Start it with 'ballast: 1'.");
  }
  if (auto applied = scene::apply_overrides(*root, overrides); !applied) return applied.error();
  const std::filesystem::path path(file);
  scene::ReadState state;
  state.folder = path.parent_path().string();
  Scene result;
  result.name = path.stem().string();
  scene::Reader::read_map(state, {"scene", scene::kNone, ""}, *root, [&](auto& v) { visit(v, result); });
  if (!state.error) scene::expand_repeats(result, state);
  if (!state.error) scene::check_scene(result, root->place, state);
  if (state.error) return *state.error;
  return result;
}

Result<Scene> read_scene(const std::string& path, const Overrides& overrides) {
  std::error_code none;
  std::ifstream in(path);
  if (!std::filesystem::is_regular_file(path, none) || !in) {
    return Error{fmt::format("the scene file '{}' cannot be read", path),
                 "Check the path and the permission to read it.", path};
  }
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  return read_scene_text(text, path, overrides);
}

}  // namespace ballast
