// What `ballast doctor` says and how it ends; what it finds is tested on a machine of its own (tests/faults/contained).
#include "launch/doctor.h"

#include <gtest/gtest.h>

namespace ballast::launch {
namespace {

using State = Finding::State;
const Finding kGood{State::kFine, "pictures", "povray", ""};
const Finding kNoPictures{State::kAbsent, "pictures", "no povray", "apt-get install povray"};
const Finding kNoMemory{State::kFault, "shared memory", "full", "make room"};

TEST(Doctor, SaysWhatIsFineInOneLineAndTheCureOfTheRestBelow) {
  EXPECT_EQ(finding_text(kGood), "ok      pictures: povray");
  EXPECT_EQ(finding_text(kNoPictures), "absent  pictures: no povray\n        cure: apt-get install povray");
  EXPECT_EQ(finding_text(kNoMemory), "FAULT   shared memory: full\n        cure: make room");
}

TEST(Doctor, EndsWithZeroWhereARunWouldWork) {
  EXPECT_EQ(doctor_verdict({}), kFine);
  EXPECT_EQ(doctor_verdict({kGood, kNoPictures}), kFine);
  EXPECT_EQ(doctor_verdict({kNoMemory, kGood}), kProcessFailed);
}

}  // namespace
}  // namespace ballast::launch
