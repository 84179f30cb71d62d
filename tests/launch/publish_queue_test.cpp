// The queue between coordinator and publishing thread: bounded, never waiting, honest about what it dropped.
#include "launch/publish_queue.h"

#include <gtest/gtest.h>

#include <thread>

namespace ballast::launch {
namespace {

using namespace std::chrono_literals;

TEST(PublishQueue, GivesBackInOrder) {
  PublishQueue<int> queue(100);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(queue.offer(i, 10));
  queue.close(9);
  for (int wanted : {0, 1, 2, 9}) EXPECT_EQ(queue.take(), wanted);
  EXPECT_EQ(queue.take(), std::nullopt);
  EXPECT_EQ(queue.dropped(), 0u);
}

TEST(PublishQueue, RefusesAndCountsWhatDoesNotFitAndHasRoomAgainAfterwards) {
  PublishQueue<int> queue(100);
  EXPECT_TRUE(queue.offer(1, 60));
  EXPECT_FALSE(queue.offer(2, 60));
  EXPECT_TRUE(queue.offer(3, 40));
  EXPECT_FALSE(queue.offer(4, 1));
  EXPECT_EQ(queue.dropped(), 2u);
  EXPECT_EQ(queue.take(), 1);
  EXPECT_TRUE(queue.offer(5, 60));
}

TEST(PublishQueue, HasRoomForTheLastItemAlwaysAndForNothingAfterIt) {
  PublishQueue<int> queue(10);
  EXPECT_TRUE(queue.offer(1, 10));
  queue.close(2);
  EXPECT_FALSE(queue.offer(3, 0));
  EXPECT_EQ(queue.take(), 1);
  EXPECT_EQ(queue.take(), 2);
  EXPECT_EQ(queue.take(), std::nullopt);
}

/// One that waited for the taker would wait for ever.
TEST(PublishQueue, DoesNotWaitLongForATakerThatIsStuckAndCountsWhatIsLeft) {
  PublishQueue<int> queue(100);
  for (int i = 0; i < 5; ++i) queue.offer(i, 1);
  EXPECT_EQ(queue.take(), 0);  // and never comes back
  queue.close(9);
  EXPECT_FALSE(queue.wait_done(50ms));
  EXPECT_EQ(queue.dropped(), 5u);  // 1 to 4, and the last
  EXPECT_EQ(queue.take(), std::nullopt) << "a taker that wakes up later must find the end";
}

TEST(PublishQueue, LosesNothingBetweenTwoThreads) {
  PublishQueue<int> queue(1000);
  std::uint64_t taken = 0;
  int last = -1;
  std::thread taker([&] {
    for (auto item = queue.take(); item; item = queue.take()) {
      EXPECT_GT(*item, last);
      last = *item;
      ++taken;
    }
    queue.mark_done();
  });
  for (int i = 0; i < 20000; ++i) queue.offer(i, 1);
  queue.close(20000);
  EXPECT_TRUE(queue.wait_done(10s));
  taker.join();
  EXPECT_EQ(last, 20000);
  EXPECT_EQ(taken + queue.dropped(), 20001u);
}

}  // namespace
}  // namespace ballast::launch
