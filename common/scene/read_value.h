// From one value of the file to one member, with every complaint that a value can earn.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/field.h"
#include "common/scene/node.h"

namespace ballast::scene {

/// What is known while a scene is read. The first error wins; after it nothing more is read.
struct ReadState {
  std::optional<Error> error;
  double spacing = 0;                                           ///< m, for lengths in spacings; 0: not known yet
  std::string folder;                                           ///< base of relative paths
  std::vector<Repeat> repeats;                                  ///< one per model as written
  std::map<std::pair<std::string, std::string>, Place> places;  ///< (where a map is, key) -> where its value is

  void fail(const Place& place, std::string what, std::string cure);
  /// Where the value behind these keys was written, starting from the map at `base`; the last known place on the way.
  Place find(Place base, std::initializer_list<std::string_view> keys) const;
};

void read_value(ReadState&, const Field&, const Node&, double&);
void read_value(ReadState&, const Field&, const Node&, int&);
void read_value(ReadState&, const Field&, const Node&, std::uint64_t&);
void read_value(ReadState&, const Field&, const Node&, bool&);
void read_value(ReadState&, const Field&, const Node&, std::string&);
void read_value(ReadState&, const Field&, const Node&, Vec3&);
void read_value(ReadState&, const Field&, const Node&, Quat&);
void read_value(ReadState&, const Field&, const Node&, std::optional<double>&);
void read_value(ReadState&, const Field&, const Node&, std::array<int, 3>&);
void read_value(ReadState&, const Field&, const Node&, Name);
void read_value(ReadState&, const Field&, const Node&, MeshFile);
void read_value(ReadState&, const Field&, const Node&, Axis);
void read_value(ReadState&, const Field&, const Node&, Factors);
void read_value(ReadState&, const Field&, const Node&, Ground);
void read_value(ReadState&, const Field&, const Node&, Axes);
void read_value(ReadState&, const Field&, const Node&, MostLost);
void read_value(ReadState&, const Field&, const Node&, Tolerance);

/// [x, y, z] or [x, y, z, roll, pitch, yaw].
void read_pose_list(ReadState&, const Node&, Pose&);

/// The text of a plain value; fails on lists, maps and nothing. `form` says what is wanted.
const std::string* plain_text(ReadState&, const Field&, const Node&, std::string_view form);

/// The index of the written word; fails with the nearest one.
std::optional<size_t> read_word(ReadState&, const Field&, const Node&, const std::vector<std::string>& words);

/// Fails with "a map is needed, but this is a list" and the like unless `node` is of the kind.
bool is_kind(ReadState&, const Field&, const Node&, Node::Kind kind);

}  // namespace ballast::scene
