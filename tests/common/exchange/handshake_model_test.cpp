// Model check of the waiting: all interleavings of a poster and a waiter, as README.md describes them, are walked
// through. The sleeper flag must never be lost; variants that are known to be wrong must be found out.
#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

namespace {

enum class Variant { kOurs, kPosterClearsFlag, kPosterReadsFlagFirst, kWaiterReadsWordFirst };

constexpr int kMessages = 3;

/// One moment: program counters and everything shared. `seen` is the waiter's private copy of the word.
struct Moment {
  int word = 0, flag = 0, poster = 0, posted = 0, read_flag = 0, waiter = 0, seen = 0, asleep = 0;
  auto operator<=>(const Moment&) const = default;
};

// Poster, per message: 0 store the word (or first read the flag), 1 the other of the two, 2 clear (wrong variant), 3
// wake.
std::vector<Moment> poster_steps(const Moment& m, Variant v) {
  if (m.posted == kMessages) return {};
  Moment n = m;
  const bool flag_first = v == Variant::kPosterReadsFlagFirst;
  const auto next_message = [&] { n.poster = 0, n.posted += 1; };
  if (m.poster == 0 || m.poster == 1) {
    const bool store = (m.poster == 0) != flag_first;
    if (store) n.word += 1;
    if (!store) n.read_flag = m.flag;
    n.poster += 1;
    if (m.poster == 1) {
      if (!n.read_flag) next_message();
      if (n.read_flag && v != Variant::kPosterClearsFlag) n.poster = 3;
    }
  } else if (m.poster == 2) {
    n.flag = 0;
    n.poster = 3;
  } else {
    n.asleep = 0;
    next_message();
  }
  return {n};
}

// Waiter, per wait: 0 word moved already?, 1 set the flag, 2 word moved?, 3 futex wait: sleeps only if the word has not
// moved, which the kernel decides in one piece, 4 clear the flag. In the wrong variant 2 is done before 1 only.
std::vector<Moment> waiter_steps(const Moment& m, Variant v) {
  if (m.asleep || (m.seen == kMessages && m.waiter == 0)) return {};
  Moment n = m;
  const bool moved = m.word != m.seen;
  switch (m.waiter) {
    case 0:
      if (moved)
        n.seen = m.word;
      else
        n.waiter = 1;
      break;
    case 1:
      n.flag = 1;
      n.waiter = v == Variant::kWaiterReadsWordFirst ? 5 : 2;
      break;
    case 2:
      n.waiter = moved ? 4 : 3;
      break;
    case 3:
      if (!moved) n.asleep = 1;
      n.waiter = 2;
      break;
    case 4:
      n.flag = 0;
      n.seen = m.word;
      n.waiter = 0;
      break;
    default:  // sleeps on a mere "something", not on the word: what a condition without a check would do
      n.asleep = 1;
      n.waiter = 2;
  }
  return {n};
}

/// Number of moments from which nothing can happen although the waiter has not got all messages.
int deadlocks(Variant v, std::size_t* moments = nullptr) {
  std::set<Moment> known{{}};
  std::vector<Moment> open{{}};
  int found = 0;
  while (!open.empty()) {
    const Moment m = open.back();
    open.pop_back();
    std::vector<Moment> next = poster_steps(m, v);
    for (const Moment& n : waiter_steps(m, v)) next.push_back(n);
    if (next.empty() && m.seen != kMessages) ++found;
    for (const Moment& n : next) {
      if (known.insert(n).second) open.push_back(n);
    }
  }
  if (moments) *moments = known.size();
  return found;
}

TEST(handshake_model, no_interleaving_loses_a_wake_up) {
  std::size_t moments = 0;
  EXPECT_EQ(deadlocks(Variant::kOurs, &moments), 0);
  EXPECT_GT(moments, 100u) << "the walk must have gone somewhere";
}
TEST(handshake_model, finds_the_flag_that_the_poster_clears) { EXPECT_GT(deadlocks(Variant::kPosterClearsFlag), 0); }
TEST(handshake_model, finds_the_flag_read_before_the_word_is_visible) {
  EXPECT_GT(deadlocks(Variant::kPosterReadsFlagFirst), 0);
}
TEST(handshake_model, finds_the_sleep_without_a_second_look) {
  EXPECT_GT(deadlocks(Variant::kWaiterReadsWordFirst), 0);
}

}  // namespace
