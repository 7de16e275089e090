// The configurations of deploy/ in front of two real servers: HAProxy's and nginx', whichever is
// installed.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <thread>

#include "core/base/files.h"
#include "server/access/access_token.h"
#include "tests/deploy/served_program.h"
#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::ask;
using test::RunningProgram;
using test::ServedProgram;
using Clock = std::chrono::steady_clock;

constexpr seconds kPatience{15};
constexpr std::size_t kMostText = std::size_t{1} << 22;

std::string deployed(const char* name) {
  return read_file(std::filesystem::path("deploy") / name, kMostText);
}

/// Replaces what must be there.
void replace(std::string& text, const std::string& what, const std::string& with) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size()) {
    text.replace(at, what.size(), with);
    ++count;
  }
  ASSERT_GT(count, 0u) << what;
}

bool is_installed(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

/// "haproxy" or "nginx", before two servers with tokens and stores of their own.
class Proxies : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!is_installed(GetParam())) GTEST_SKIP() << GetParam() << " is not installed";
    test::write_small_bake(folder / "a.bake", {});
    ASSERT_EQ(test::run_program({"token", "--new-key", path("keys.json")}).status, 0);
    // One second of silence until a ping, where it is 15 by default.
    ::setenv("RIMLIGHT_IDLE_TIMEOUT_SECONDS", "2", 1);
    for (const char* const store : {"one.sqlite", "two.sqlite"}) {
      servers.push_back(std::make_unique<ServedProgram>(
          std::vector<std::string>{path("a.bake"), "--store", path(store), "--key",
                                   path("keys.json"), "--host-name", "design.example.com"}));
    }
    ::unsetenv("RIMLIGHT_IDLE_TIMEOUT_SECONDS");
    port = test::free_port();
    if (std::string(GetParam()) == "haproxy") {
      start_haproxy();
    } else {
      start_nginx();
    }
    ASSERT_FALSE(HasFatalFailure());
    wait_until_ready();
  }

  std::string path(const std::string& name) const { return (folder / name).string(); }

  /// What is deployed, with the test's ports, without TLS, and with times of 2 s for those of 60.
  void adapt(std::string& text, const std::string& listen) const {
    replace(text, listen, "127.0.0.1:" + std::to_string(port));
    replace(text, "127.0.0.1:8081", "127.0.0.1:" + std::to_string(servers[0]->port()));
    replace(text, "127.0.0.1:8082", "127.0.0.1:" + std::to_string(servers[1]->port()));
    replace(text, " 60s", " 2s");
  }

  void start_haproxy() {
    std::string text = deployed("haproxy.cfg");
    adapt(text, ":443 ssl crt /etc/haproxy/rimlight.pem alpn http/1.1");
    replace(text, "log /dev/log local0", "log stdout format raw local0");
    std::ofstream(folder / "haproxy.cfg") << text;
    proxy = std::make_unique<RunningProgram>(
        "haproxy", std::vector<std::string>{"-db", "-f", path("haproxy.cfg")});
  }

  void start_nginx() {
    std::string text = deployed("nginx.conf");
    adapt(text, "443 ssl");
    replace(text, "/var/log/nginx", folder.path().string());
    text = std::regex_replace(text, std::regex(R"(  ssl_certificate[^\n]*\n)"), "");
    std::ofstream(folder / "rimlight.inc") << text;
    std::ofstream(folder / "nginx.conf")
        << "events {}\nhttp { include " << path("rimlight.inc") << "; }\n";
    proxy = std::make_unique<RunningProgram>(
        "nginx",
        std::vector<std::string>{"-p", folder.path().string(), "-c", path("nginx.conf"), "-e",
                                 path("start.log"), "-g",
                                 "daemon off; master_process off; pid " + path("nginx.pid") + ";"});
  }

  void wait_until_ready() {
    const auto end = Clock::now() + kPatience;
    while (get("/readyz").substr(0, 12) != "HTTP/1.1 200") {
      ASSERT_TRUE(proxy->is_running()) << proxy->errors() << proxy->output();
      ASSERT_LT(Clock::now(), end) << get("/readyz");
      std::this_thread::sleep_for(milliseconds(20));
    }
  }

  std::string token(server::Role role, const std::string& session) const {
    const auto now = server::WallClock::now();
    return server::issue_token({role, session, "", now + std::chrono::hours(1)},
                               server::read_signing_keys(path("keys.json")), now);
  }
  std::string get(const std::string& target, const std::string& host = "design.example.com") const {
    return ask(port,
               "GET " + target + " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n");
  }
  /// The status of an upgrade with those headers.
  std::string upgrade(const std::string& target, const std::string& host,
                      const std::string& headers = "") const {
    const std::string response = ask(port,
                                     "GET " + target + " HTTP/1.1\r\nHost: " + host +
                                         "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                                         "Sec-WebSocket-Version: 13\r\n"
                                         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
                                         headers + "\r\n",
                                     test::Answer::header);
    return response.size() < 12 ? response : response.substr(9, 3);
  }
  std::unique_ptr<StreamClient> open(const std::string& session) const {
    return std::make_unique<StreamClient>(
        StreamUrl{"127.0.0.1", std::to_string(port)},
        "/sessions/" + session + "/stream?token=" + token(server::Role::editor, session));
  }
  /// A sample of a server's own /metrics.
  int metric(const ServedProgram& server, const std::string& name) const {
    const std::string text =
        server.get("/metrics", "Authorization: Bearer " + token(server::Role::owner, "*") + "\r\n");
    const std::size_t at = text.find("\n" + name + " ");
    EXPECT_NE(at, std::string::npos) << text.substr(0, 200);
    return at == std::string::npos ? -1 : std::stoi(text.substr(at + name.size() + 2));
  }

  test::TemporaryFolder folder;
  std::vector<std::unique_ptr<ServedProgram>> servers;
  std::uint16_t port = 0;
  std::unique_ptr<RunningProgram> proxy;
};

/// The next text of that type; null when none comes.
json next(StreamClient& client, const std::string& type) {
  for (const auto end = Clock::now() + kPatience; Clock::now() < end;) {
    const auto received = client.receive(end);
    if (std::holds_alternative<StreamClient::Closed>(received)) break;
    if (const auto* const text = std::get_if<StreamClient::Text>(&received)) {
      json message = json::parse(text->text);
      if (message["type"] == type) return message;
    }
  }
  return nullptr;
}

TEST_P(Proxies, AllClientsOfASessionReachTheSameServer) {
  constexpr int kSessions = 13, kClients = 3;  // odd: taking turns would spread each session
  std::vector<std::unique_ptr<StreamClient>> clients;
  for (int client = 0; client < kClients; ++client) {
    for (int session = 0; session < kSessions; ++session) {
      clients.push_back(open("room-" + std::to_string(session)));
      ASSERT_TRUE(next(*clients.back(), "welcome").is_object());
    }
  }
  // Were one session on both servers, there would be more than these in all.
  const int first = metric(*servers[0], "rimlight_sessions");
  const int second = metric(*servers[1], "rimlight_sessions");
  EXPECT_EQ(first + second, kSessions);
  EXPECT_GT(first, 0);
  EXPECT_GT(second, 0);
  EXPECT_EQ(metric(*servers[0], "rimlight_connections"), kClients * first);
  EXPECT_EQ(metric(*servers[1], "rimlight_connections"), kClients * second);
  // One's edit is the others' state.
  ASSERT_TRUE(clients[0]->send_text(R"({"type":"edit","id":"1","exposure":1.5})"));
  const json state = next(*clients[kSessions], "state");
  ASSERT_TRUE(state.is_object());
  EXPECT_EQ(state["state"]["exposure"], 1.5);
}

TEST_P(Proxies, LongSilenceDoesNotCutAConnection) {
  const auto client = open("quiet");
  ASSERT_TRUE(next(*client, "welcome").is_object());
  // More than twice the proxy's time; the client answers pings while it waits.
  for (const auto end = Clock::now() + seconds(5); Clock::now() < end;) {
    ASSERT_FALSE(std::holds_alternative<StreamClient::Closed>(client->receive(end)));
  }
  ASSERT_TRUE(client->send_text(R"({"type":"edit","id":"1","exposure":1.5})"));
  EXPECT_TRUE(next(*client, "ack").is_object());
}

TEST_P(Proxies, HostsOriginsAndTokensAreCheckedAsWithoutThem) {
  const std::string target = "/sessions/a/stream?token=" + token(server::Role::viewer, "a");
  EXPECT_EQ(upgrade(target, "design.example.com"), "101");
  EXPECT_EQ(upgrade(target, "evil.example"), "421");
  EXPECT_EQ(upgrade(target, "design.example.com", "Origin: https://design.example.com\r\n"), "101");
  EXPECT_EQ(upgrade(target, "design.example.com", "Origin: https://evil.example\r\n"), "403");
  EXPECT_EQ(upgrade("/sessions/a/stream", "design.example.com"), "401");
  EXPECT_EQ(
      upgrade("/sessions/b/stream?token=" + token(server::Role::viewer, "a"), "design.example.com"),
      "403");
  EXPECT_EQ(get("/").substr(9, 3), "200");
  EXPECT_EQ(get("/api/scenes").substr(9, 3), "401");
  EXPECT_EQ(get("/metrics").substr(9, 3), "404");
}

TEST_P(Proxies, NoLogHasAToken) {
  const std::string shown = token(server::Role::viewer, "a");
  EXPECT_EQ(upgrade("/sessions/a/stream?token=" + shown, "design.example.com"), "101");
  EXPECT_EQ(upgrade("/sessions/b/stream?token=" + shown, "design.example.com"), "403");
  servers.clear();  // the proxy's own error, too
  EXPECT_EQ(upgrade("/sessions/a/stream?token=" + shown, "design.example.com").substr(0, 2), "50");
  proxy->terminate();
  const auto ended = proxy->wait();
  std::string logs = ended.output + ended.errors;
  for (const char* const name : {"rimlight.log", "rimlight.error.log", "start.log"}) {
    if (std::filesystem::exists(folder / name)) logs += read_file(folder / name, kMostText);
  }
  EXPECT_NE(logs.find("/sessions/a/stream"), std::string::npos) << logs;
  EXPECT_EQ(logs.find(shown.substr(0, 20)), std::string::npos) << logs;
  EXPECT_EQ(logs.find(shown.substr(shown.rfind('.') + 1, 12)), std::string::npos) << logs;
  EXPECT_EQ(logs.find("token"), std::string::npos) << logs;
}

TEST_P(Proxies, ASessionWaitsForItsServerInsteadOfBeginningAfreshOnAnother) {
  const auto client = open("kept");
  ASSERT_TRUE(next(*client, "welcome").is_object());
  ASSERT_TRUE(client->send_text(R"({"type":"edit","id":"1","exposure":1.5})"));
  ASSERT_TRUE(next(*client, "ack").is_object());
  const std::size_t owner = metric(*servers[0], "rimlight_sessions") == 1 ? 0 : 1;
  const std::uint16_t its_port = servers[owner]->port();
  servers[owner]->program().terminate();
  EXPECT_EQ(servers[owner]->program().wait().status, 0);
  const std::string again = "/sessions/kept/stream?token=" + token(server::Role::viewer, "kept");
  EXPECT_EQ(upgrade(again, "design.example.com").substr(0, 2), "50");
  EXPECT_EQ(get("/").substr(9, 3), "200");  // the page comes from the other
  servers[owner] = std::make_unique<ServedProgram>(
      std::vector<std::string>{path("a.bake"), "--store",
                               path(owner == 0 ? "one.sqlite" : "two.sqlite"), "--key",
                               path("keys.json"), "--host-name", "design.example.com"},
      its_port);
  const auto back = open("kept");
  const json welcome = next(*back, "welcome");
  EXPECT_EQ(welcome["revision"], 1);
  EXPECT_EQ(welcome["state"]["exposure"], 1.5);
}

INSTANTIATE_TEST_SUITE_P(Deployed, Proxies, testing::Values("haproxy", "nginx"),
                         [](const auto& instance) { return std::string(instance.param); });

/// Runs a command; its status, and what it says in `errors`.
int status_of(const std::string& command, const std::string& log) {
  return std::system((command + " >" + log + " 2>&1").c_str());
}

TEST(Deployed, ConfigurationsAreGoodAsTheyAreWithTls) {
  if (!is_installed("openssl") || (!is_installed("haproxy") && !is_installed("nginx"))) {
    GTEST_SKIP();
  }
  const test::TemporaryFolder folder;
  const std::string pem = (folder / "rimlight.pem").string(), log = (folder / "log").string();
  ASSERT_EQ(status_of("openssl req -x509 -newkey rsa:2048 -nodes -days 1 -subj /CN=a.example "
                      "-keyout " +
                          pem + ".key -out " + pem,
                      log),
            0);
  if (is_installed("haproxy")) {
    std::ofstream(pem + ".both") << read_file(pem, kMostText) << read_file(pem + ".key", kMostText);
    std::string text = deployed("haproxy.cfg");
    replace(text, "/etc/haproxy/rimlight.pem", pem + ".both");
    std::ofstream(folder / "haproxy.cfg") << text;
    EXPECT_EQ(status_of("haproxy -c -f " + (folder / "haproxy.cfg").string(), log), 0);
    const std::string said = read_file(log, kMostText);
    EXPECT_EQ(said.find("WARNING"), std::string::npos) << said;
    EXPECT_EQ(said.find("ALERT"), std::string::npos) << said;
  }
  if (is_installed("nginx")) {
    std::string text = deployed("nginx.conf");
    replace(text, "/etc/ssl/rimlight.pem", pem);
    replace(text, "/etc/ssl/private/rimlight.key", pem + ".key");
    replace(text, "/var/log/nginx", folder.path().string());
    std::ofstream(folder / "rimlight.inc") << text;
    std::ofstream(folder / "nginx.conf")
        << "events {}\nhttp { include " << (folder / "rimlight.inc").string() << "; }\n";
    EXPECT_EQ(status_of("nginx -t -p " + folder.path().string() + " -c " +
                            (folder / "nginx.conf").string() + " -g 'pid " + pem + ".pid;'",
                        log),
              0)
        << read_file(log, kMostText);
  }
}

TEST(Deployed, TheUnitIsWholeAndHardened) {
  if (!is_installed("systemd-analyze")) GTEST_SKIP() << "systemd-analyze is not installed";
  const test::TemporaryFolder folder;
  std::string text = deployed("rimlight.service");
  replace(text, "/opt/rimlight/bin/rimlight", RIMLIGHT_PROGRAM);
  const std::string unit = (folder / "rimlight.service").string();
  const std::string log = (folder / "log").string();
  std::ofstream(unit) << text;
  EXPECT_EQ(status_of("systemd-analyze verify --man=no " + unit, log), 0)
      << read_file(log, kMostText);
  EXPECT_EQ(read_file(log, kMostText).find("rimlight.service:"), std::string::npos)
      << read_file(log, kMostText);
  // Of 100; a unit without hardening has about 96.
  EXPECT_EQ(
      status_of("systemd-analyze security --no-pager --offline=true --threshold=15 " + unit, log),
      0)
      << read_file(log, kMostText);
}

}  // namespace
}  // namespace rimlight
