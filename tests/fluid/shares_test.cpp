// Shares of loops for threads, and the runtime that runs them.
#include "fluid_server/neighbours/shares.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <numeric>
#include <random>
#include <string>

namespace ballast::fluid {
namespace {

TEST(Shares, CoverEverythingOnceAtEqualCost) {
  std::mt19937 random(3);
  for (const std::uint32_t n : {0u, 1u, 63u, 64u, 1000u, 20000u})
    for (const int threads : {1, 2, 4}) {  // the runtime leaks where more join later
      std::vector<double> cost(n);
      // As where water lies low: the first items are dear, the last ones hardly cost anything.
      for (std::uint32_t k = 0; k < n; ++k) cost[k] = std::uniform_real_distribution<>(0, k < n / 3 ? 20 : 1)(random);
      const std::vector<std::uint32_t> shares = shares_of(n, threads, [&](std::uint32_t k) { return cost[k]; });
      ASSERT_EQ(shares.size(), static_cast<std::size_t>(threads) + 1);
      EXPECT_EQ(shares.front(), 0u);
      EXPECT_EQ(shares.back(), n);
      EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
      const double all = std::accumulate(cost.begin(), cost.end(), 0.0), grain = 64 * 20;
      for (std::size_t t = 0; t + 1 < shares.size(); ++t)
        EXPECT_NEAR(std::accumulate(cost.begin() + shares[t], cost.begin() + shares[t + 1], 0.0), all / threads, grain);
      std::vector<int> visits(n, 0);
      for_each_in(shares, threads, [&](std::uint32_t k) { ++visits[k]; });
      EXPECT_EQ(visits, std::vector<int>(n, 1)) << n << " of " << threads;
    }
}

TEST(Turns, TakeEveryTaskOnce) {
  for (const std::size_t n : {0u, 1u, 2u, 1000u})
    for (const int threads : {1, 2, 4}) {
      std::vector<int> visits(n, 0);
      for_each_by_turns(n, threads, [&](std::size_t k) { ++visits[k]; });
      EXPECT_EQ(visits, std::vector<int>(n, 1)) << n << " of " << threads;
    }
}

/// Killed, a process must not leave shared memory: there must be none with a name (openmp_runtime.cpp).
TEST(Shares, TheirThreadsLeaveNoSharedMemory) {
  int threads = 0;
#pragma omp parallel num_threads(2)
#pragma omp atomic
  ++threads;
  EXPECT_GE(threads, 1);
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm"))
    EXPECT_EQ(entry.path().filename().string().find("LIB_" + std::to_string(getpid())), std::string::npos) << entry;
}

}  // namespace
}  // namespace ballast::fluid
