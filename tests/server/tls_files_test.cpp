// The files of TLS over a server's life, by the built program: checked before it starts, replaced
// at SIGHUP, kept where the new ones are wrong; and handshakes that fail are counted and logged.
#include <gtest/gtest.h>
#include <openssl/bn.h>
#include <openssl/ssl.h>
#include <signal.h>  // NOLINT: SIGHUP is POSIX

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/base/files.h"
#include "tests/server/loopback_server.h"
#include "tests/server/metrics_text.h"
#include "tests/server/test_certificate.h"
#include "tests/support/program.h"
#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;
using rimlight::test::RunningProgram;
using std::chrono::seconds;
using test::LoopbackServer;
using test::make_certificate;
using test::RawSocket;

constexpr seconds kPatience{20};

/// Waits until it holds; whether it did in time.
template <typename Condition>
bool becomes(const Condition& condition) {
  const auto end = Clock::now() + kPatience;
  while (!condition()) {
    if (Clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

/// An open connection that believes anyone.
class SecureClient {
 public:
  explicit SecureClient(std::uint16_t port)
      : context_(SSL_CTX_new(TLS_client_method()), SSL_CTX_free),
        link_(BIO_new_ssl_connect(context_.get()), BIO_free_all) {
    BIO_set_conn_hostname(link_.get(), ("127.0.0.1:" + std::to_string(port)).c_str());
    BIO_get_ssl(link_.get(), &ssl_);
    if (BIO_do_handshake(link_.get()) != 1) throw std::runtime_error("no handshake");
  }
  /// Of the certificate that it was shown.
  std::string serial() const {
    const std::unique_ptr<X509, decltype(&X509_free)> shown(SSL_get1_peer_certificate(ssl_),
                                                            X509_free);
    const std::unique_ptr<BIGNUM, decltype(&BN_free)> number(
        ASN1_INTEGER_to_BN(X509_get_serialNumber(shown.get()), nullptr), BN_free);
    char* const text = BN_bn2hex(number.get());
    std::string serial = text;
    OPENSSL_free(text);
    return serial;
  }
  /// The first line of the answer.
  std::string get(const std::string& target) {
    const std::string request = "GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n";
    char answer[64] = {};
    BIO_write(link_.get(), request.data(), static_cast<int>(request.size()));
    const int size = BIO_read(link_.get(), answer, sizeof answer - 1);
    const std::string line(answer, static_cast<std::size_t>(std::max(size, 0)));
    return line.substr(0, line.find('\r'));
  }

 private:
  std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context_;
  std::unique_ptr<BIO, decltype(&BIO_free_all)> link_;
  SSL* ssl_ = nullptr;
};

class TlsFilesOfAServer : public testing::Test {
 protected:
  TlsFilesOfAServer() { rimlight::test::write_small_bake(folder / "a.bake", {}); }

  std::vector<std::string> command(std::vector<std::string> more) const {
    std::vector<std::string> all{"serve",
                                 (folder / "a.bake").string(),
                                 "--tls-certificate",
                                 files.certificate.string(),
                                 "--tls-key",
                                 files.key.string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  void start() {
    server = std::make_unique<RunningProgram>(command({"--port", "0", "--json", "--log", "json"}));
    ASSERT_TRUE(becomes(
        [&] { return !server->is_running() || server->output().find('\n') != std::string::npos; }));
    ASSERT_TRUE(server->is_running()) << server->errors();
    const std::string address = json::parse(server->output())["address"];
    ASSERT_TRUE(address.starts_with("https://"));
    port = static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1)));
  }
  /// How many events of that name are in the log.
  int logged(const std::string& event) const {
    const std::string text = server->errors(), wanted = "\"event\":\"" + event + "\"";
    int count = 0;
    for (std::size_t at = text.find(wanted); at != std::string::npos;
         at = text.find(wanted, at + 1)) {
      ++count;
    }
    return count;
  }

  rimlight::test::TemporaryFolder folder;
  TlsFiles files = make_certificate(folder.path());
  std::unique_ptr<RunningProgram> server;
  std::uint16_t port = 0;
};

TEST_F(TlsFilesOfAServer, AreReadAgainAtSighupAndKeptWhereTheNewOnesAreWrong) {
  const std::string first = test::serial_of(files.certificate);
  ASSERT_NO_FATAL_FAILURE(start());
  SecureClient open(port);
  EXPECT_EQ(open.serial(), first);
  make_certificate(folder.path());
  const std::string second = test::serial_of(files.certificate);
  ASSERT_NE(first, second);
  EXPECT_EQ(SecureClient(port).serial(), first) << "before it was told";
  server->signal(SIGHUP);
  ASSERT_TRUE(becomes([&] { return logged("certificate_read") == 1; })) << server->errors();
  EXPECT_EQ(SecureClient(port).serial(), second);
  EXPECT_EQ(open.get("/healthz"), "HTTP/1.1 200 OK") << "what was open goes on";
  // A key that is not of the certificate; then no certificate at all.
  const std::string good = read_file(files.certificate, 1 << 20);
  make_certificate(folder.path());
  std::ofstream(files.certificate) << good;
  server->signal(SIGHUP);
  ASSERT_TRUE(becomes([&] { return logged("certificate_kept") == 1; })) << server->errors();
  EXPECT_NE(server->errors().find("server.key"), std::string::npos);
  EXPECT_EQ(SecureClient(port).serial(), second);
  std::ofstream(files.certificate) << "nonsense";
  server->signal(SIGHUP);
  ASSERT_TRUE(becomes([&] { return logged("certificate_kept") == 2; })) << server->errors();
  EXPECT_EQ(SecureClient(port).serial(), second);
  server->terminate();
  EXPECT_EQ(server->wait().status, 0);
}

TEST_F(TlsFilesOfAServer, AreReadByCheckConfig) {
  const auto check = [&] { return rimlight::test::run_program(command({"--check-config"})); };
  const auto well = check();
  EXPECT_EQ(well.status, 0) << well.errors;
  const auto expect_fault = [&](const std::string& named) {
    const auto result = check();
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.output, "");
    EXPECT_NE(result.errors.find(named), std::string::npos) << result.errors;
  };
  fs::permissions(files.key, fs::perms::group_read, fs::perm_options::add);
  expect_fault("server.key");
  fs::permissions(files.key, fs::perms::group_read, fs::perm_options::remove);
  const std::string other = read_file(files.certificate, 1 << 20);
  make_certificate(folder.path());
  ASSERT_EQ(check().status, 0);
  std::ofstream(files.certificate) << other;  // not of this key
  expect_fault("server.key");
  std::ofstream(files.certificate) << "nonsense";
  expect_fault("server.crt");
  fs::remove(files.certificate);
  expect_fault("server.crt");
}

TEST_F(TlsFilesOfAServer, HandshakesThatFailAreCountedAndTheirLogIsBounded) {
  LoopbackServer::Settings settings;
  settings.network.tls = files;
  settings.network.metrics = std::make_shared<ServerMetrics>();
  const LoopbackServer loopback(settings);
  const auto failures = [&] {
    return test::parse_metrics(settings.network.metrics->to_text())
        .at("rimlight_refusals_total{reason=\"tls\"}");
  };
  const SecureClient well(loopback.port());
  EXPECT_EQ(failures(), 0);
  constexpr int kMany = 5;
  for (int i = 0; i < kMany; ++i) {
    RawSocket clear(loopback.port());
    clear.send("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
    clear.read_all();
  }
  EXPECT_TRUE(becomes([&] { return failures() == kMany; })) << failures();
  // By the program, since its log is its own.
  ASSERT_NO_FATAL_FAILURE(start());
  constexpr int kFlood = 230;  // of one event 200 lines may come at once
  for (int i = 0; i < kFlood; ++i) {
    RawSocket clear(port);
    clear.send("GET /?token=secret HTTP/1.1\r\n\r\n");
    clear.read_all();
  }
  EXPECT_TRUE(becomes([&] { return logged("handshake_failed") >= 100; })) << server->errors();
  EXPECT_EQ(SecureClient(port).get("/healthz"), "HTTP/1.1 200 OK");
  EXPECT_EQ(server->errors().find("secret"), std::string::npos);
  EXPECT_NE(server->errors().find("http request"), std::string::npos) << "OpenSSL's reason";
}

}  // namespace
}  // namespace rimlight::server
