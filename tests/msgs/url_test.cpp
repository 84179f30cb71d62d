// URLs: nothing leaves the machine unless the user wrote it.
#include "msgs/url.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace ballast::msgs {
namespace {

struct Url : ::testing::Test {
  void SetUp() override { unsetenv("LCM_DEFAULT_URL"); }
  void TearDown() override { unsetenv("LCM_DEFAULT_URL"); }
};

TEST_F(Url, StaysOnThisMachineByDefault) {
  EXPECT_EQ(*url_to_open(""), "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304");
}

TEST_F(Url, GetsNoTtlButZeroUnlessWritten) {
  EXPECT_EQ(*url_to_open("udpm://239.1.2.3:7000"), "udpm://239.1.2.3:7000?ttl=0");
  EXPECT_EQ(*url_to_open("udpm://"), "udpm://?ttl=0");
  EXPECT_EQ(*url_to_open("udpm://239.1.2.3:7000?recv_buf_size=9"), "udpm://239.1.2.3:7000?recv_buf_size=9&ttl=0");
  EXPECT_EQ(*url_to_open("udpm://239.1.2.3:7000?xttl=1"), "udpm://239.1.2.3:7000?xttl=1&ttl=0");
  EXPECT_EQ(*url_to_open("udpm://239.1.2.3:7000?recv_buf_size=9&ttl=1"), "udpm://239.1.2.3:7000?recv_buf_size=9&ttl=1");
}

TEST_F(Url, OfOtherProvidersStaysAsItIs) {
  for (const char* url : {"tcpq://127.0.0.1:7700", "memq://", "file:///tmp/a.log?mode=w"}) {
    EXPECT_EQ(*url_to_open(url), url);
  }
}

TEST_F(Url, ComesFromTheEnvironmentWhereNoneIsGivenAndIsTreatedAlike) {
  setenv("LCM_DEFAULT_URL", "udpm://239.9.9.9:1234", 1);
  EXPECT_EQ(*url_to_open(""), "udpm://239.9.9.9:1234?ttl=0");
  EXPECT_EQ(*url_to_open("memq://"), "memq://");
}

TEST_F(Url, OfAnUnknownProviderIsRefusedWithTheKnownOnes) {
  for (const char* url : {"hello", "upd://239.255.76.67:7667", "://"}) {
    const auto refused = url_to_open(url);
    ASSERT_FALSE(refused) << url;
    EXPECT_NE(refused.error().what.find(url), std::string::npos);
    EXPECT_NE(refused.error().cure.find("udpm, tcpq, memq or file"), std::string::npos);
    EXPECT_EQ(refused.error().exit_code, kBadInput);
  }
}

}  // namespace
}  // namespace ballast::msgs
