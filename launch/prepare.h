// From a scene file to what a run needs and what it can do without.
#pragma once
#include <string>
#include <vector>

#include "common/geometry/bodies.h"
#include "common/result.h"
#include "common/scene/reader.h"
#include "common/scene/scene.h"
#include "launch/choose.h"

namespace ballast::launch {

// Parts of a run that can be left out, and counted.
inline constexpr const char* kFluidProcess = "fluid process";
inline constexpr const char* kRigidProcess = "rigid process";
inline constexpr const char* kMessages = "messages over LCM";
inline constexpr const char* kContactSets = "contact sets";
inline constexpr const char* kVtk = "ParaView files";
inline constexpr const char* kViscous = "viscous forces";
inline constexpr const char* kDensities = "densities of particles";
inline constexpr const char* kFilms = "films between solids";
inline constexpr const char* kShifting = "particle shifting";
inline constexpr const char* kCompression = "implicit pressure";

/// A part that this scene does without.
struct LeftOut {
  std::string what, why, saved, difference;
};

struct Prepared {
  Scene scene;
  std::vector<Body> bodies;
  bool fluid = false, rigid = false;  ///< which processes take part
  std::vector<LeftOut> left_out;
  Choices choices = {};                    ///< why the scene's `auto` became what it is now
  std::vector<std::string> warnings = {};  ///< what a look at the scene foretells; the processes warn of it themselves
  std::vector<std::string> oddities = {};  ///< the same of what no process warns of
  bool contact_sets = false;               ///< go to the engine with every step
  bool contacts_shown = false;             ///< are assembled whenever a message with them is due
};

/// A message of the fluid process that begins with a fluid's path, by the fluid's place in the file instead: the
/// processes do not know it.
std::string in_the_file(const Prepared& prepared, const std::string& message);

/// A rigid process that somebody starts by hand may be any: it is taken to read contact sets.
void expect_foreign_engine(Prepared& prepared);

/// Refuses probes of level and pressure at places that the fluid never reaches: there they would report a number that
/// nobody measured.
Status check_probes(const Scene& scene, const std::vector<Body>& bodies);

/// A line for every body (all copies of one together) that is wholly outside world.domain or every container, or
/// thinner than a particle: place, name, size, cure.
std::vector<std::string> odd_bodies(const Prepared& prepared);

/// Reads and checks a scene and makes its bodies. A scene without fluid and without moving bodies is an error.
Result<Prepared> prepare(const std::string& scene_file, const Overrides& overrides);
/// The same from a scene that was read already; `scene_file` is for messages.
Result<Prepared> prepare(Scene scene, const std::string& scene_file);

/// Particles that the fills will hold, by sampling (to about 1 %): fill volume less the bodies in it, over
/// spacing^dimension.
double estimate_particles(const Prepared& prepared);

}  // namespace ballast::launch
