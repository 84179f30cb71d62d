// How fast particles meet what is around them: what bounds the step of a fluid without sound. A drop in free flight
// goes through nothing, however fast it is, until it comes near something.
#pragma once
#include "fluid_server/neighbours/neighbourhood.h"
#include "fluid_server/particles/particles.h"

namespace ballast::fluid {

/// Largest speed, m/s, of any particle against its neighbours, particles and samples in its list. Particles have the
/// velocities that count, the lists' particles the places that they had when the lists were made. Only the fastest
/// hundredth is looked at; the others count with their own speed, as if what is around them were at rest. `alone` is
/// what counts of the speed of a particle in free flight: it may move further in a step, but not past what it does not
/// see yet.
double meeting_speed(const Particles& particles, const Neighbourhood& items, double alone, int threads);

}  // namespace ballast::fluid
