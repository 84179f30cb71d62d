// Which of many numbers is larger than all but a few.
#pragma once
#include <cstddef>
#include <span>

namespace ballast::fluid {

/// The one of some numbers >= 0 that k are larger than, by counting their bits (which order like they do) eleven at a
/// time: all threads count, and the result does not depend on their number.
float larger_than_all_but(std::size_t k, std::span<const float> numbers, int threads);

}  // namespace ballast::fluid
