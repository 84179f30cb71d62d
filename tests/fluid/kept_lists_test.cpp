// Lists that are kept while no item leaves its cell are those of a fresh search, in the same order.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "fluid_server/passes/passes.h"

namespace ballast::fluid {
namespace {

struct KeptCase {
  int dimension;
  KernelKind kind;
  bool periodic;
  int threads;
};

class KeptLists : public ::testing::TestWithParam<KeptCase> {
 protected:
  static constexpr double kSpacing = 0.02;

  KeptLists() {
    constants_.kernel = kernel_;
    constants_.sound_speed = 2;
    constants_.diffusion = 0.1f;
    constants_.dt = 1e-4f;
    constants_.threads = GetParam().threads;
    extras_.density.assign(1, 1000.f);
    std::uniform_real_distribution<double> u(0.0, 1.0);
    for (int k = 0; k < (plane() ? 900 : 4000); ++k) {
      Record r{0, 0, 0, float(100 * u(random_)), float(u(random_)), 0, float(u(random_)), 8e-6f};
      for (auto [axis, cells] : axes()) {  // away from the borders of the cells, which small moves must not cross
        const std::uint64_t width = (1ull << 32) / cells, cell = static_cast<std::uint64_t>(u(random_) * cells);
        r.*axis = static_cast<std::uint32_t>(static_cast<double>(cell * width) +
                                             (0.1 + 0.8 * u(random_)) * static_cast<double>(width));
      }
      if (k % 5 == 0) r.volume = -r.volume;
      (k % 5 ? particles_.record : k % 2 ? fixed_ : moving_).push_back(r);
    }
    for (std::uint32_t f = 0; f < particles_.record.size(); ++f) particles_.id.push_back(f);
    searching_.may_keep = false;
    for (Neighbourhood* items : {&keeping_, &searching_}) items->set_static_samples(fixed_);
  }

  static bool plane() { return GetParam().dimension == 2; }
  std::vector<std::pair<std::uint32_t Record::*, std::uint32_t>> axes() const {
    const auto& n = keeping_.cells().count;
    if (plane()) return {{&Record::x, n[0]}, {&Record::z, n[2]}};
    return {{&Record::x, n[0]}, {&Record::y, n[1]}, {&Record::z, n[2]}};
  }
  /// Moves of up to `share` spacings along each axis.
  void shake(std::vector<Record>& records, double share) {
    std::uniform_real_distribution<double> u(-share * kSpacing, share * kSpacing);
    for (Record& r : records)
      for (auto [axis, cells] : axes())
        r.*axis +=
            static_cast<std::uint32_t>(std::llround(u(random_) / coordinates_.quantum[axis == &Record::x   ? 0
                                                                                      : axis == &Record::y ? 1
                                                                                                           : 2]));
  }
  std::vector<float> search(Neighbourhood& items, Particles& sorted) {
    std::vector<float> pressure;
    items.rebuild(particles_, sorted, moving_, static_cast<std::uint32_t>(fixed_.size()));
    build_lists_and_advance_pressure(items, extras_, constants_, pressure);
    return pressure;
  }
  void expect_the_same() const {
    ASSERT_EQ(keeping_.source, searching_.source);
    ASSERT_EQ(keeping_.fluid_item, searching_.fluid_item);
    ASSERT_EQ(keeping_.sample_item, searching_.sample_item);
    ASSERT_EQ(0, std::memcmp(keeping_.record.data(), searching_.record.data(), keeping_.size() * sizeof(Record)));
    ASSERT_EQ(keeping_.lists.count, searching_.lists.count);
    for (std::uint32_t i = 0; i < keeping_.size(); ++i)
      ASSERT_TRUE(
          std::equal(keeping_.lists.of(i), keeping_.lists.of(i) + keeping_.lists.count[i], searching_.lists.of(i)))
          << "item " << i;
  }

  std::mt19937 random_{11};
  Kernel kernel_ = Kernel::of(GetParam().kind, GetParam().dimension, kSpacing);
  Coordinates coordinates_ =
      Coordinates::make(plane() ? Box3{{-0.3, -0.5, 0.1}, {0.31, 0.5, 0.7}} : Box3{{-0.15, 0.02, 0.1}, {0.2, 0.3, 0.4}},
                        {GetParam().periodic, false, GetParam().periodic});
  Neighbourhood keeping_{coordinates_, kernel_.support, GetParam().dimension, GetParam().threads};
  Neighbourhood searching_{coordinates_, kernel_.support, GetParam().dimension, GetParam().threads};
  Particles particles_;
  std::vector<Record> fixed_, moving_;
  PassConstants constants_;
  ItemExtras extras_;
};

TEST_P(KeptLists, AreThoseOfAFreshSearch) {
  for (int round = 0; round < 80; ++round) {
    SCOPED_TRACE(round);
    Particles kept, sorted;
    const std::vector<float> pressure = search(keeping_, kept);
    ASSERT_EQ(pressure, search(searching_, sorted));
    ASSERT_EQ(kept.id, sorted.id);
    ASSERT_EQ(0, std::memcmp(kept.record.data(), sorted.record.data(), sorted.size() * sizeof(Record)));
    expect_the_same();
    std::swap(particles_, kept);
    for (std::uint32_t item : keeping_.sample_item) keeping_.record[item].p = 7;  // as the boundary does
    // Mostly small moves; in every tenth step some leave their cells, once particles are lost, once the order changes.
    shake(particles_.record, round % 10 == 9 ? 0.1 : 1e-5 * (1 << round % 10));
    if (round % 3) shake(moving_, 1e-4);
    if (round == 33) particles_.resize(particles_.size() - 5);
    if (round == 55)
      std::swap(particles_.record[3], particles_.record[4]), std::swap(particles_.id[3], particles_.id[4]);
  }
  EXPECT_GT(keeping_.searches.lists, 20 * keeping_.size()) << "no power: lists were hardly ever kept";
  EXPECT_GT(keeping_.searches.made_again, keeping_.size() / 100) << "no power: no pair came or went";
  EXPECT_EQ(searching_.searches.lists, 0u);
}

TEST_P(KeptLists, AreNotMeasuredInEveryStepOfAFlow) {
  int measured = 0;
  for (int round = 0; round < 200; ++round) {
    Particles kept;
    search(keeping_, kept);
    measured += keeping_.lists.measure;
    std::swap(particles_, kept);
    shake(particles_.record, 0.2);
  }
  EXPECT_EQ(keeping_.searches.lists, 0u);
  EXPECT_LE(measured, 8);  // after 0, 1, 3, 7, 15, 31, 63 others
  // At rest they are kept before long.
  for (int round = 0; round < 100; ++round) {
    Particles kept;
    search(keeping_, kept);
    std::swap(particles_, kept);
  }
  EXPECT_GT(keeping_.searches.lists, 30 * keeping_.size());
  EXPECT_LT(keeping_.searches.made_again, keeping_.searches.lists / 500);  // pairs exactly at the rim
}

INSTANTIATE_TEST_SUITE_P(All, KeptLists,
                         ::testing::Values(KeptCase{2, KernelKind::kWendland, false, 1},
                                           KeptCase{2, KernelKind::kWendland, true, 2},
                                           KeptCase{3, KernelKind::kWendland, true, 2},
                                           KeptCase{3, KernelKind::kCubic, false, 3}));

}  // namespace
}  // namespace ballast::fluid
