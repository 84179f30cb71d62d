// What this machine can do, measured in the process whose figures are divided by it.
#pragma once

namespace ballast::bench {

/// Fused multiply-adds in registers, widest vectors of this processor, GFlop/s of all `threads` together (2 per lane).
double fma_peak(int threads);

/// a = b + s c over 120 MB, GB/s counted as 12 bytes per element (the write-allocate is not counted).
double triad_bandwidth(int threads);

}  // namespace ballast::bench
