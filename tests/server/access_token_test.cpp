#include "server/access/access_token.h"

#include <gtest/gtest.h>

#include "tests/support/error_of.h"
#include "tests/support/signed_token.h"

namespace rimlight::server {
namespace {

using rimlight::test::base64url;
using rimlight::test::error_of;
using rimlight::test::signed_token;
using std::chrono::hours;
using std::chrono::seconds;

const std::string kSecret(32, 's');
const SigningKeys kKeys({{"a", kSecret}, {"b", std::string(40, 't')}});
const WallClock::time_point kNow{seconds(1'800'000'000)};
const std::string kHeader = R"({"alg":"HS256","typ":"JWT","kid":"a"})";
const std::string kClaims =
    R"({"role":"editor","session":"room","exp":1800000100,"iat":1800000000})";

Access editor_of(const std::string& session) {
  return {Role::editor, session, "Ann", kNow + hours(8)};
}

std::string outcome(const std::string& token, WallClock::time_point now = kNow,
                    const SigningKeys& keys = kKeys) {
  const auto checked = check_token(token, keys, now);
  const auto* const fault = std::get_if<TokenFault>(&checked);
  return fault ? to_string(*fault) : "believed";
}

TEST(AccessTokens, AreBelievedAsTheyWereIssued) {
  for (const Role role : {Role::viewer, Role::editor, Role::owner}) {
    const Access given{role, "room", "Ånn \"O'Neil\"", kNow + hours(8)};
    const auto checked = check_token(issue_token(given, kKeys, kNow), kKeys, kNow);
    ASSERT_TRUE(std::holds_alternative<Access>(checked));
    const Access& access = std::get<Access>(checked);
    EXPECT_EQ(access.role, role);
    EXPECT_EQ(access.session, given.session);
    EXPECT_EQ(access.name, given.name);
    EXPECT_EQ(access.expires, given.expires);
    EXPECT_TRUE(access.opens("room"));
    EXPECT_FALSE(access.opens("other"));
    EXPECT_FALSE(access.opens("*"));
  }
  EXPECT_TRUE(editor_of("*").opens("other"));
}

TEST(AccessTokens, AreJsonWebTokensOfTheStandard) {
  EXPECT_EQ(outcome(signed_token(kHeader, kClaims, kSecret)), "believed");
  const std::string issued = issue_token(editor_of("room"), kKeys, kNow);
  // RFC 7515, 3.1: what is signed is the text of the first two parts.
  const std::size_t first = issued.find('.');
  const std::size_t second = issued.rfind('.');
  const auto decoded = [](std::string text) {
    std::replace(text.begin(), text.end(), '-', '+');
    std::replace(text.begin(), text.end(), '_', '/');
    text.append((4 - text.size() % 4) % 4, 'A');
    std::string bytes(text.size(), '\0');
    EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()),
                    reinterpret_cast<const unsigned char*>(text.data()),
                    static_cast<int>(text.size()));
    return bytes.substr(0, bytes.rfind('}') + 1);
  };
  EXPECT_EQ(signed_token(decoded(issued.substr(0, first)),
                         decoded(issued.substr(first + 1, second - first - 1)), kSecret),
            issued);
}

TEST(AccessTokens, OneFlippedBitAnywhereIsNotBelieved) {
  const std::string token = issue_token(editor_of("room"), kKeys, kNow);
  ASSERT_EQ(outcome(token), "believed");
  for (std::size_t i = 0; i < token.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string flipped = token;
      flipped[i] = static_cast<char>(flipped[i] ^ (1 << bit));
      EXPECT_NE(outcome(flipped), "believed") << "byte " << i << ", bit " << bit;
    }
  }
}

TEST(AccessTokens, EveryShorterOrLongerOneIsNotBelieved) {
  const std::string token = issue_token(editor_of("room"), kKeys, kNow);
  for (std::size_t size = 0; size < token.size(); ++size) {
    EXPECT_NE(outcome(token.substr(0, size)), "believed") << size;
    EXPECT_NE(outcome(token.substr(token.size() - size)), "believed") << size;
  }
  for (const char* const more : {"A", "=", ".", " ", "\n", "AAAA", ".AAAA"}) {
    EXPECT_NE(outcome(token + more), "believed") << more;
    EXPECT_NE(outcome(more + token), "believed") << more;
  }
  EXPECT_NE(outcome(token + std::string(1, '\0')), "believed");
}

TEST(AccessTokens, HugeOnesAreRefusedBeforeTheyAreParsed) {
  EXPECT_EQ(outcome(std::string(100'000'000, 'A')), "malformed");
  // A valid one, but for its size.
  const std::string padded = kClaims.substr(0, kClaims.size() - 1) + std::string(800, ' ') + "}";
  EXPECT_EQ(outcome(signed_token(kHeader, padded, kSecret)), "malformed");
  const std::string nested = std::string(300, '[') + std::string(300, ']');
  EXPECT_NE(outcome(signed_token(kHeader, nested, kSecret)), "believed");
}

TEST(AccessTokens, ExpireAndAreNotYetValidWithinTheBoundOfTheClocks) {
  const std::string token = signed_token(kHeader, kClaims, kSecret);
  EXPECT_EQ(outcome(token, kNow - kClockSkew), "believed");
  EXPECT_EQ(outcome(token, kNow - kClockSkew - seconds(1)), "from the future");
  EXPECT_EQ(outcome(token, kNow + seconds(100) + kClockSkew - seconds(1)), "believed");
  EXPECT_EQ(outcome(token, kNow + seconds(100) + kClockSkew), "expired");
}

TEST(AccessTokens, OfAnotherKeyAreNotBelieved) {
  const std::string token = issue_token(editor_of("room"), kKeys, kNow);
  EXPECT_EQ(outcome(token, kNow, SigningKeys({{"a", std::string(32, 'x')}})), "forged");
  EXPECT_EQ(outcome(token, kNow, SigningKeys({{"c", kSecret}})), "of an unknown key");
  // A secret with the id of another key, and one byte more.
  const std::string other = R"({"alg":"HS256","kid":"b"})";
  EXPECT_EQ(outcome(signed_token(other, kClaims, kSecret)), "forged");
  EXPECT_EQ(outcome(signed_token(kHeader, kClaims, kSecret + "s")), "forged");
}

TEST(AccessTokens, OfAnOlderKeyAreBelievedUntilItIsTakenOut) {
  const std::string old = issue_token(editor_of("room"), SigningKeys({{"a", kSecret}}), kNow);
  const SigningKeys rotated({{"new", std::string(32, 'n')}, {"a", kSecret}});
  EXPECT_EQ(outcome(old, kNow, rotated), "believed");
  EXPECT_EQ(outcome(issue_token(editor_of("room"), rotated, kNow), kNow, kKeys),
            "of an unknown key");
  EXPECT_EQ(outcome(old, kNow, SigningKeys({{"new", std::string(32, 'n')}})), "of an unknown key");
}

TEST(AccessTokens, OtherAlgorithmsAreRefusedHoweverWellSigned) {
  const auto header = [](const std::string& algorithm) {
    return R"({"typ":"JWT","kid":"a","alg":")" + algorithm + "\"}";
  };
  for (const char* const name : {"none", "None", "NONE", "HS384", "HS512", "RS256", "ES256", ""}) {
    EXPECT_NE(outcome(signed_token(header(name), kClaims, kSecret)), "believed") << name;
    const std::string unsigned_part = base64url(header(name)) + "." + base64url(kClaims);
    EXPECT_NE(outcome(unsigned_part + "."), "believed") << name;
    EXPECT_NE(outcome(unsigned_part), "believed") << name;
  }
  EXPECT_NE(outcome(signed_token(header("HS384"), kClaims, kSecret, EVP_sha384())), "believed");
  EXPECT_NE(outcome(signed_token(header("HS512"), kClaims, kSecret, EVP_sha512())), "believed");
  EXPECT_NE(outcome(signed_token(R"({"kid":"a"})", kClaims, kSecret)), "believed");
  EXPECT_NE(outcome(signed_token(R"({"alg":"HS256"})", kClaims, kSecret)), "believed");
}

TEST(AccessTokens, WithOtherClaimsAreRefusedHoweverWellSigned) {
  for (const char* const claims :
       {"{}", "[]", "1", R"({"role":"editor","session":"room","exp":1800000100})",
        R"({"role":"editor","session":"room","iat":1800000000})",
        R"({"role":"editor","exp":1800000100,"iat":1800000000})",
        R"({"session":"room","exp":1800000100,"iat":1800000000})",
        R"({"role":"god","session":"room","exp":1800000100,"iat":1800000000})",
        R"({"role":2,"session":"room","exp":1800000100,"iat":1800000000})",
        R"({"role":"editor","session":"../x","exp":1800000100,"iat":1800000000})",
        R"({"role":"editor","session":"room","exp":"never","iat":1800000000})",
        R"({"role":"editor","session":"room","exp":1e300,"iat":1800000000})",
        R"({"role":"editor","session":"room","exp":9223372036854775807,"iat":0})",
        R"({"role":"editor","session":"room","exp":1800000100,"iat":-1})",
        R"({"role":"editor","session":"room","exp":1800000100,"iat":1800000000,"admin":true})",
        R"({"role":"editor","session":"room","exp":1800000100,"iat":1800000000,"name":"a\u0007"})",
        "nonsense", ""}) {
    EXPECT_NE(outcome(signed_token(kHeader, claims, kSecret)), "believed") << claims;
  }
}

TEST(AccessTokens, AreNotIssuedForWhatWouldNotBeBelieved) {
  const auto refusal = [](const Access& access) {
    return error_of([&] { issue_token(access, kKeys, kNow); });
  };
  EXPECT_NE(refusal(editor_of("a b")).find("the session \"a b\""), std::string::npos);
  EXPECT_NE(refusal(editor_of("")), "no error");
  EXPECT_NE(refusal({Role::editor, "room", std::string(65, 'n'), kNow + hours(1)}), "no error");
  EXPECT_NE(refusal({Role::editor, "room", "a\nb", kNow + hours(1)}), "no error");
  EXPECT_NE(refusal({Role::editor, "room", "", kNow}).find("expiry"), std::string::npos);
  EXPECT_NE(refusal({Role::editor, "room", "", kNow + hours(24 * 400)}), "no error");
  EXPECT_EQ(refusal(editor_of(std::string(64, 'a'))), "no error");
}

}  // namespace
}  // namespace rimlight::server
