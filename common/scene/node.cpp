// yaml-cpp is used here and nowhere else: its nodes become our tree, its exceptions our errors.
#include "common/scene/node.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <charconv>
#include <optional>
#include <sstream>

#include "common/scene/nearest.h"

namespace ballast::scene {

const Entry* Node::find(std::string_view key) const {
  for (const Entry& entry : map) {
    if (entry.key == key) return &entry;
  }
  return nullptr;
}

Entry* Node::find(std::string_view key) { return const_cast<Entry*>(std::as_const(*this).find(key)); }

std::string where(const Place& place) {
  return place.line > 0 ? fmt::format("{}:{}:{}", place.file, place.line, place.column) : place.file;
}

Error error_at(const Place& place, std::string what, std::string cure) {
  constexpr std::size_t kShown = 400;  // a value of megabytes is quoted by its ends
  if (what.size() > kShown) what = what.substr(0, kShown / 2) + " ... " + what.substr(what.size() - kShown / 2);
  return {std::move(what), std::move(cure), where(place)};
}

namespace {

constexpr int kMostDeep = 64;          // aliases can make a document endless
constexpr int kMostNodes = 2'000'000;  // or as large as one likes

Place place_of(const YAML::Mark& mark, const std::string& file) {
  return mark.line < 0 ? Place{file, 0, 0} : Place{file, mark.line + 1, mark.column + 1};
}

class Converter {
 public:
  explicit Converter(std::string file) : file_(std::move(file)) {}

  Result<Node> convert(const YAML::Node& from, int depth = 0) {
    Node node;
    node.place = place_of(from.Mark(), file_);
    if (depth > kMostDeep || ++count_ > kMostNodes) {
      return error_at(node.place, "the document is nested or repeated without end",
                      "Remove the alias (*name) that causes it.");
    }
    if (from.IsScalar()) {
      node.kind = Node::Kind::kText;
      node.text = from.Scalar();
    } else if (from.IsSequence()) {
      node.kind = Node::Kind::kList;
      for (const YAML::Node& item : from) {
        auto child = convert(item, depth + 1);
        if (!child) return child;
        node.list.push_back(*std::move(child));
      }
    } else if (from.IsMap()) {
      node.kind = Node::Kind::kMap;
      for (const auto& pair : from) {
        if (auto added = add(node, pair.first, pair.second, depth); !added) return added.error();
      }
    }
    return node;
  }

 private:
  Status add(Node& node, const YAML::Node& key, const YAML::Node& value, int depth) {
    const Place place = place_of(key.Mark(), file_);
    if (!key.IsScalar()) return error_at(place, "a key is not plain text", "Write 'key: value' with a word as key.");
    if (const Entry* first = node.find(key.Scalar())) {
      return error_at(place, fmt::format("the key '{}' appears twice, first at {}", key.Scalar(), where(first->place)),
                      "Remove one of the two.");
    }
    auto child = convert(value, depth + 1);
    if (!child) return child.error();
    if (child->kind == Node::Kind::kNothing) child->place = place;
    node.map.push_back({key.Scalar(), place, 0, *std::move(child)});
    return ok();
  }

  std::string file_;
  int count_ = 0;
};

/// The list item with this name or index; nullptr if there is none.
Node* list_item(Node& list, std::string_view step) {
  for (Node& item : list.list) {
    const Entry* name = item.find("name");
    if (name != nullptr && name->value.text == step) return &item;
  }
  size_t index = 0;
  const auto [end, error] = std::from_chars(step.data(), step.data() + step.size(), index);
  if (error != std::errc() || end != step.data() + step.size() || index >= list.list.size()) return nullptr;
  return &list.list[index];
}

Error no_such_item(const Place& place, const Node& list, std::string_view step) {
  std::vector<std::string> names;
  for (const Node& item : list.list) {
    if (const Entry* name = item.find("name")) names.push_back(name->value.text);
  }
  return error_at(place, fmt::format("there is no list item '{}'", step),
                  names.empty()
                      ? fmt::format("Items have no names here; use an index from 0 to {}.", int(list.list.size()) - 1)
                      : suggestion(step, names));
}

void mark_all(Node& node, const Place& place, int rank) {
  node.place = place;
  for (Node& item : node.list) mark_all(item, place, rank);
  for (Entry& entry : node.map) {
    entry.place = place;
    entry.rank = rank;
    mark_all(entry.value, place, rank);
  }
}

/// The node at `path`, made on the way where keys are absent.
Result<Node*> walk(Node& root, std::string_view path, const Place& place, int rank) {
  Node* node = &root;
  while (!path.empty()) {
    const std::string_view step = path.substr(0, path.find('.'));
    path.remove_prefix(std::min(path.size(), step.size() + 1));
    if (step.empty()) return error_at(place, "the path has an empty step", "Write it as key.name.key=value.");
    if (node->kind == Node::Kind::kNothing) node->kind = Node::Kind::kMap, node->place = place;
    if (node->kind == Node::Kind::kList) {
      Node* item = list_item(*node, step);
      if (item == nullptr) return no_such_item(place, *node, step);
      node = item;
    } else if (node->kind == Node::Kind::kMap) {
      Entry* entry = node->find(step);
      if (entry == nullptr) {
        node->map.push_back({std::string(step), place, rank, {}});
        entry = &node->map.back();
        entry->value.place = place;
      }
      if (path.empty()) entry->rank = rank;
      node = &entry->value;
    } else {
      return error_at(place, fmt::format("'{}' leads into the plain value '{}'", step, node->text),
                      "End the path at that value.");
    }
  }
  return node;
}

/// Where a second document starts. YAML::LoadAll would build all of them, and there are damaged files in which it finds
/// documents without end.
class SecondDocument : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark&) override { ++count_; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& at, YAML::anchor_t) override { see(at); }
  void OnAlias(const YAML::Mark& at, YAML::anchor_t) override { see(at); }
  void OnScalar(const YAML::Mark& at, const std::string&, YAML::anchor_t, const std::string&) override { see(at); }
  void OnSequenceStart(const YAML::Mark& at, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    see(at);
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& at, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    see(at);
  }
  void OnMapEnd() override {}

  /// Nothing if there is none.
  static std::optional<YAML::Mark> find(const std::string& text) {
    std::istringstream in(text);
    YAML::Parser parser(in);
    SecondDocument look;
    if (!parser.HandleNextDocument(look) || !parser.HandleNextDocument(look)) return std::nullopt;
    return look.first_;
  }

 private:
  void see(const YAML::Mark& at) {
    if (count_ == 2 && !first_) first_ = at;
  }
  int count_ = 0;
  std::optional<YAML::Mark> first_;
};

}  // namespace

Result<Node> parse_yaml(const std::string& text, const std::string& file) {
  try {
    const YAML::Node document = YAML::Load(text);
    if (!document || document.IsNull()) {
      return error_at({file, 0, 0}, "the file is empty", "Start it with 'ballast: 1'.");
    }
    if (const auto second = SecondDocument::find(text)) {
      return error_at(place_of(*second, file), "a second document starts here", "Remove the line '---' before it.");
    }
    return Converter(file).convert(document);
  } catch (const YAML::Exception& error) {
    return error_at(place_of(error.mark, file), fmt::format("YAML syntax: {}", error.msg),
                    "Look at indentation, brackets and quotes here and just above.");
  }
}

Status apply_overrides(Node& root, const Overrides& overrides) {
  int rank = 0;
  for (const auto& [path, text] : overrides) {
    ++rank;
    const Place place{"--set " + path, 0, 0};
    if (path.empty()) return error_at(place, "the path is empty", "Write --set key.name.key=value.");
    auto value = parse_yaml(text, place.file);
    if (!value) {
      return error_at(place, fmt::format("the value '{}' cannot be read: {}", text, value.error().what),
                      "Write it as it would stand in the scene file.");
    }
    mark_all(*value, place, rank);
    auto target = walk(root, path, place, rank);
    if (!target) return target.error();
    **target = *std::move(value);
  }
  return ok();
}

}  // namespace ballast::scene
