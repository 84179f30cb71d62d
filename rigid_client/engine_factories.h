// The makers of all engines, for the table in engines.cpp.
#pragma once
#include <memory>

#include "rigid_client/engine.h"

namespace ballast::rigid {

std::unique_ptr<Engine> make_ode_engine();
std::unique_ptr<Engine> make_free_body_engine();

}  // namespace ballast::rigid
