#include "server/access/signing_keys.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "server/access/access_token.h"
#include "tests/support/error_of.h"
#include "tests/support/signed_token.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

using rimlight::test::base64url;
using rimlight::test::error_of;

std::string key_text(const std::string& id, const std::string& secret) {
  return R"({"kty":"oct","kid":")" + id + R"(","k":")" + base64url(secret) + "\"}";
}

class SigningKeyFiles : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text, ::mode_t mode = 0600) {
    const std::filesystem::path file = folder_ / "keys.json";
    std::filesystem::remove(file);
    std::ofstream(file) << text;
    ::chmod(file.c_str(), mode);
    return file;
  }
  std::string refusal(const std::string& text, ::mode_t mode = 0600) {
    const auto file = write(text, mode);
    return error_of([&] { read_signing_keys(file); });
  }

  rimlight::test::TemporaryFolder folder_;
};

TEST_F(SigningKeyFiles, AreReadAsTheyStandTheFirstKeySigns) {
  for (std::size_t size = kShortestSecret; size < 100; ++size) {
    std::string secret(size, '\0');
    for (std::size_t i = 0; i < size; ++i) secret[i] = static_cast<char>(i * 37 + size);
    const SigningKeys keys = read_signing_keys(write("{\"keys\":[" + key_text("one", secret) + "," +
                                                     key_text("two", secret + "x") + "]}"));
    EXPECT_EQ(keys.newest().id, "one");
    EXPECT_EQ(keys.newest().secret, secret);
    ASSERT_NE(keys.find("two"), nullptr);
    EXPECT_EQ(keys.find("two")->secret, secret + "x");
    EXPECT_EQ(keys.find("three"), nullptr);
  }
}

TEST_F(SigningKeyFiles, ThatOthersMayUseAreRefused) {
  const std::string text = "{\"keys\":[" + key_text("a", std::string(32, 's')) + "]}";
  EXPECT_EQ(refusal(text, 0600), "no error");
  EXPECT_EQ(refusal(text, 0400), "no error");
  for (const ::mode_t mode : {0640u, 0620u, 0604u, 0602u, 0610u, 0601u, 0644u, 0777u}) {
    EXPECT_NE(refusal(text, mode).find("chmod 600"), std::string::npos) << std::oct << mode;
  }
  EXPECT_NE(error_of([&] { read_signing_keys(folder_ / "none"); }).find("No such file"),
            std::string::npos);
  EXPECT_NE(error_of([&] { read_signing_keys(folder_.path()); }).find("no regular file"),
            std::string::npos);
}

TEST_F(SigningKeyFiles, ThatAreMalformedAreRefusedWithoutShowingASecret) {
  const std::string secret(31, 'q');
  const std::string encoded = base64url(secret);
  const std::string good = key_text("a", std::string(32, 's'));
  for (const std::string& text :
       {std::string(), std::string("{}"), std::string("[]"), std::string("{\"keys\":[]}"),
        std::string("{\"keys\":[1]}"), encoded, "\"" + encoded + "\"",
        "{\"keys\":[" + key_text("a", secret) + "]}",          // too short
        "{\"keys\":[" + good + "," + good + "]}",              // one id twice
        "{\"keys\":[" + key_text("a b", secret + "q") + "]}",  // no name
        "{\"keys\":[{\"kid\":\"a\",\"k\":\"" + encoded + "\"}]}",
        R"({"keys":[{"kty":"RSA","kid":"a","k":")" + encoded + "\"}]}",
        R"({"keys":[{"kty":"oct","alg":"none","kid":"a","k":")" + encoded + "\"}]}",
        R"({"keys":[{"kty":"oct","kid":"a","k":")" + encoded + "=\"}]}",
        R"({"keys":[{"kty":"oct","kid":"a","k":[")" + encoded + "\"]}]}",
        R"({"keys":[{"kty":"oct","kid":"a","k":")" + encoded,
        "{\"keys\":[" + key_text("a", std::string(1025, 'q')) + "]}",
        std::string(70000, ' ') + "{\"keys\":[" + good + "]}"}) {
    const std::string error = refusal(text);
    EXPECT_NE(error, "no error") << text;
    EXPECT_EQ(error.find(encoded.substr(0, 8)), std::string::npos) << error;
  }
}

TEST_F(SigningKeyFiles, AreMadeForOneUserAloneAndNeverOverwritten) {
  const auto file = folder_ / "new.json";
  make_key_file(file, "2026-11");
  struct stat status {};
  ASSERT_EQ(::stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777u, 0600u);
  const SigningKeys keys = read_signing_keys(file);
  EXPECT_EQ(keys.newest().id, "2026-11");
  EXPECT_EQ(keys.newest().secret.size(), kShortestSecret);
  EXPECT_NE(error_of([&] { make_key_file(file, "again"); }).find("exists"), std::string::npos);
  EXPECT_EQ(read_signing_keys(file).newest().secret, keys.newest().secret);
  make_key_file(folder_ / "other.json", "2026-11");
  EXPECT_NE(read_signing_keys(folder_ / "other.json").newest().secret, keys.newest().secret);
  EXPECT_NE(error_of([&] { make_key_file(folder_ / "x.json", "a b"); }), "no error");
}

}  // namespace
}  // namespace rimlight::server
