// Names of the channels; each carries one type of this folder.
#pragma once
#include <string_view>

namespace ballast::msgs {

inline constexpr const char* kStatus = "BALLAST_STATUS";        ///< status_t
inline constexpr const char* kBodies = "BALLAST_BODIES";        ///< body_states_t
inline constexpr const char* kWrenches = "BALLAST_WRENCHES";    ///< wrenches_t
inline constexpr const char* kContacts = "BALLAST_CONTACTS";    ///< contact_sets_t
inline constexpr const char* kFluid = "BALLAST_FLUID";          ///< fluid_statistics_t
inline constexpr const char* kParticles = "BALLAST_PARTICLES";  ///< particles_t
inline constexpr const char* kWarning = "BALLAST_WARNING";      ///< warning_t

inline constexpr const char* kCommand = "BALLAST_COMMAND";  ///< command_t, to a run
/// Of a run, for lists of what there is.
inline constexpr std::string_view kAll[] = {kStatus, kBodies, kWrenches, kContacts, kFluid, kParticles, kWarning};

}  // namespace ballast::msgs
