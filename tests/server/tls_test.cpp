// TLS over a real socket: what it serves, whom it refuses, and how a certificate is replaced.
#include <gtest/gtest.h>
#include <openssl/ssl.h>
#include <signal.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "server/access/access_token.h"
#include "server/network/tls_context.h"
#include "tests/server/door_client.h"
#include "tests/server/loopback_server.h"
#include "tests/server/test_certificate.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;
using rimlight::test::error_of;
using rimlight::test::TemporaryFolder;
using std::chrono::seconds;
using test::LoopbackServer;
using test::make_certificate;
using test::RawSocket;

constexpr seconds kPatience{10};

LoopbackServer::Settings with_tls(const TlsFiles& files) {
  LoopbackServer::Settings settings;
  settings.network.tls = files;
  return settings;
}

StreamUrl url_of(const LoopbackServer& server) {
  return {"127.0.0.1", std::to_string(server.port()), true};
}

TEST(Tls, ServesASessionByWssAndItsFramesArriveWhole) {
  const TemporaryFolder folder;
  const TlsFiles files = make_certificate(folder.path());
  const LoopbackServer server(with_tls(files));
  StreamClient client(url_of(server), "/sessions/a/stream", {"", files.certificate});
  bool welcomed = false, exact = false;
  const auto end = Clock::now() + kPatience;
  while (!exact && Clock::now() < end) {
    const auto received = client.receive(end);
    ASSERT_FALSE(std::holds_alternative<StreamClient::Closed>(received));
    if (const auto* const text = std::get_if<StreamClient::Text>(&received)) {
      welcomed = welcomed || json::parse(text->text)["type"] == "welcome";
    } else if (const auto* const frame = std::get_if<StreamClient::Binary>(&received)) {
      exact = parse_frame_message(frame->bytes, "frame").header.exact;
    }
  }
  EXPECT_TRUE(welcomed);
  EXPECT_TRUE(exact);
  client.close();
}

TEST(Tls, ATokenIsWantedThereTooAndTheHeaderCarriesIt) {
  const TemporaryFolder folder;
  const TlsFiles files = make_certificate(folder.path());
  LoopbackServer::Settings settings = with_tls(files);
  settings.network.keys =
      std::make_shared<const SigningKeys>(std::vector<SigningKey>{{"key", std::string(32, 'k')}});
  const LoopbackServer server(settings);
  const auto now = WallClock::now();
  const std::string token = issue_token({Role::editor, "a", "Ann", now + std::chrono::hours(1)},
                                        *settings.network.keys, now);
  const auto open = [&](const std::string& shown) {
    StreamClient client(url_of(server), "/sessions/a/stream", {shown, files.certificate});
  };
  EXPECT_EQ(error_of([&] { open(token); }), "no error");
  EXPECT_NE(error_of([&] { open(""); }).find("HTTP status 401"), std::string::npos);
}

TEST(Tls, AClientDoesNotBelieveAnotherAuthorityOrAnotherName) {
  const TemporaryFolder folder, other_folder;
  const TlsFiles files = make_certificate(folder.path(), "design.example");
  const TlsFiles other = make_certificate(other_folder.path());
  const LoopbackServer server(with_tls(files));
  const auto refusal = [&](const StreamUrl& url, const fs::path& authority) {
    return error_of([&] { StreamClient(url, "/sessions/a/stream", {"", authority}); });
  };
  EXPECT_EQ(refusal(url_of(server), files.certificate), "no error");
  EXPECT_NE(refusal(url_of(server), other.certificate).find("certificate verify failed"),
            std::string::npos);
  EXPECT_NE(refusal(url_of(server), "").find("certificate verify failed"), std::string::npos);
  StreamUrl by_name = url_of(server);
  by_name.host = "localhost";  // which this certificate is not of
  EXPECT_NE(refusal(by_name, files.certificate).find("certificate verify failed"),
            std::string::npos);
}

TEST(Tls, WhoSpeaksInTheClearOrNonsenseIsClosedAndOthersGoOn) {
  const TemporaryFolder folder;
  const TlsFiles files = make_certificate(folder.path());
  LoopbackServer::Settings settings = with_tls(files);
  settings.network.handshake_timeout = seconds(1);  // some of it could still become a record
  const LoopbackServer server(settings);
  const std::string hello = "\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03";
  for (const std::string& bytes :
       {std::string("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"), std::string(3000, '\0'),
        hello + std::string(506, '\xff'), std::string("\x80\x2e\x01\x00\x02", 5)}) {
    RawSocket socket(server.port());
    socket.send(bytes);
    const std::string answer = socket.read_all();  // an alert of TLS, or nothing
    EXPECT_EQ(answer.find("HTTP"), std::string::npos) << answer;
  }
  EXPECT_EQ(error_of([&] {
              StreamClient(url_of(server), "/sessions/a/stream", {"", files.certificate});
            }),
            "no error");
}

TEST(Tls, AHandshakeThatDoesNotComeEndsAtTheDeadline) {
  const TemporaryFolder folder;
  LoopbackServer::Settings settings = with_tls(make_certificate(folder.path()));
  settings.network.handshake_timeout = seconds(1);
  const LoopbackServer server(settings);
  RawSocket silent(server.port()), dripping(server.port());
  const auto start = Clock::now();
  for (int i = 0; i < 15; ++i) {
    dripping.send(i == 0 ? "\x16" : "\x03");
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_EQ(silent.read_all(), "");
  dripping.read_all();
  EXPECT_LT(Clock::now() - start, seconds(4));
}

TEST(Tls, VersionsBefore12AreNotSpoken) {
  const TemporaryFolder folder;
  const LoopbackServer server(with_tls(make_certificate(folder.path())));
  const auto version_of = [&](int most) {
    const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(
        SSL_CTX_new(TLS_client_method()), SSL_CTX_free);
    SSL_CTX_set_security_level(context.get(), 0);
    SSL_CTX_set_min_proto_version(context.get(), TLS1_VERSION);
    SSL_CTX_set_max_proto_version(context.get(), most);
    const std::unique_ptr<BIO, decltype(&BIO_free_all)> link(BIO_new_ssl_connect(context.get()),
                                                             BIO_free_all);
    BIO_set_conn_hostname(link.get(), ("127.0.0.1:" + std::to_string(server.port())).c_str());
    SSL* ssl = nullptr;
    BIO_get_ssl(link.get(), &ssl);
    return BIO_do_handshake(link.get()) == 1 ? SSL_version(ssl) : 0;
  };
  EXPECT_EQ(version_of(TLS1_3_VERSION), TLS1_3_VERSION);
  EXPECT_EQ(version_of(TLS1_2_VERSION), TLS1_2_VERSION);
  EXPECT_EQ(version_of(TLS1_1_VERSION), 0);
}

TEST(Tls, FilesThatCannotBeUsedAreErrorsThatNameThem) {
  const TemporaryFolder folder, other_folder;
  const TlsFiles files = make_certificate(folder.path());
  const TlsFiles other = make_certificate(other_folder.path());
  EXPECT_NE(error_of([&] {
              server_tls({files.certificate, {}});
            }).find("without its key"),
            std::string::npos);
  EXPECT_NE(error_of([&] {
              server_tls({{}, files.key});
            }).find("without its certificate"),
            std::string::npos);
  EXPECT_NE(error_of([&] {
              server_tls({files.certificate, other.key});
            }).find("server.key"),
            std::string::npos);
  EXPECT_NE(error_of([&] {
              server_tls({files.key, files.key});
            }).find("chain of certificates"),
            std::string::npos);
  EXPECT_NE(error_of([&] {
              server_tls({folder / "none.crt", files.key});
            }).find("none.crt"),
            std::string::npos);
  fs::permissions(files.key, fs::perms::group_read, fs::perm_options::add);
  EXPECT_NE(error_of([&] { server_tls(files); }).find("chmod 600"), std::string::npos);
}

}  // namespace
}  // namespace rimlight::server
