#include "server/access/host_policy.h"

#include <gtest/gtest.h>

#include "tests/support/error_of.h"

namespace rimlight::server {
namespace {

using rimlight::test::error_of;
using Reach = HostPolicy::Reach;

TEST(HostPolicies, OnLoopbackOnlyLoopbackAndListedNamesAreTheServers) {
  const HostPolicy policy(Reach::loopback, {"design.example"}, {});
  for (const char* const host :
       {"localhost", "LocalHost:8080", "127.0.0.1", "127.0.0.1:1", "127.9.9.9", "[::1]",
        "[::1]:8080", "design.example", "DESIGN.example:443", "localhost:"}) {
    EXPECT_TRUE(policy.allows_host(host)) << host;
  }
  for (const char* const host : {"",
                                 "evil.example",
                                 "localhost.evil.example",
                                 "localhost.",
                                 "evil.example:8080",
                                 "192.168.1.1",
                                 "8.8.8.8:80",
                                 "[::2]",
                                 "[2001:db8::1]",
                                 "[::1",
                                 "::1",
                                 "[localhost]",
                                 "[127.0.0.1]",
                                 "127.1",
                                 "0x7f.0.0.1",
                                 "2130706433",
                                 "127.0.0.1:80:80",
                                 "localhost:x",
                                 "localhost:123456",
                                 "[::1]x",
                                 "localhost/",
                                 "user@localhost",
                                 "localhost evil",
                                 "design.example.evil",
                                 "adesign.example",
                                 ":8080"}) {
    EXPECT_FALSE(policy.allows_host(host)) << host;
  }
  EXPECT_FALSE(policy.allows_host(std::string(100000, '1')));
  EXPECT_FALSE(policy.allows_host(std::string("localhost\0", 10)));
}

TEST(HostPolicies, OnANetworkAddressesInDigitsCannotMeanAnotherMachine) {
  const HostPolicy policy(Reach::network, {}, {});
  for (const char* const host : {"192.168.1.1", "8.8.8.8:80", "[2001:db8::1]:8080", "localhost"}) {
    EXPECT_TRUE(policy.allows_host(host)) << host;
  }
  for (const char* const host : {"evil.example", "192.168.1.1.evil.example", "2001:db8::1", "1"}) {
    EXPECT_FALSE(policy.allows_host(host)) << host;
  }
}

TEST(HostPolicies, TheOwnOriginIsThatOfHostWithItsPort) {
  const HostPolicy policy(Reach::network, {}, {"https://app.example:8443", "http://[::1]:3000"});
  EXPECT_TRUE(policy.allows_origin("http://host:1", "host:1"));
  EXPECT_TRUE(policy.allows_origin("https://HOST:1", "host:1"));
  EXPECT_TRUE(policy.allows_origin("https://APP.example:8443", "host:1"));
  EXPECT_TRUE(policy.allows_origin("http://[::1]:3000", "host:1"));
  for (const char* const origin :
       {"", "null", "host:1", "http://", "http://host", "http://host:2", "ws://host:1",
        "http://host:1/", "http://host:1.evil", "https://app.example", "http://app.example:8443"}) {
    EXPECT_FALSE(policy.allows_origin(origin, "host:1")) << origin;
  }
  EXPECT_FALSE(policy.allows_origin("http://", ""));
}

TEST(HostPolicies, NamesAndOriginsThatAreNoneAreErrorsThatShowThem) {
  for (const char* const name : {"", "a b", "host:80", "http://host", "*", "[::1]", "a/b"}) {
    EXPECT_NE(error_of([&] { HostPolicy(Reach::loopback, {name}, {}); }).find("host name"),
              std::string::npos)
        << name;
  }
  for (const char* const origin :
       {"", "host", "*", "null", "https://", "https://a/", "https://a/b", "ftp://a", "https://a b",
        "https://[::1", "https://[x]", "https://a:b"}) {
    EXPECT_NE(error_of([&] { HostPolicy(Reach::loopback, {}, {origin}); }).find("origin"),
              std::string::npos)
        << origin;
  }
}

}  // namespace
}  // namespace rimlight::server
