// /readyz tells whether the server should get new work, and why not.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "tests/server/door_client.h"
#include "tests/server/faulty_disk.h"
#include "tests/server/loopback_server.h"

namespace rimlight::server {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::FaultyDisk;
using test::LoopbackServer;

struct Readiness {
  std::string status;
  json body;
};

Readiness readiness(const LoopbackServer& server) {
  const std::string response = test::http(server.port(), "GET", "/readyz");
  return {test::status_line(response).substr(9, 3),
          json::parse(response.substr(response.find("\r\n\r\n") + 4))};
}

/// Polls until the status is that.
Readiness wait_for(const LoopbackServer& server, const std::string& status) {
  const auto end = Clock::now() + seconds(15);
  Readiness now = readiness(server);
  while (now.status != status && Clock::now() < end) {
    std::this_thread::sleep_for(milliseconds(10));
    now = readiness(server);
  }
  return now;
}

constexpr const char* kEdit = R"({"type":"edit","id":"1","rotation":[0,0,0,1]})";

TEST(Readiness, AServerThatWorksIsReady) {
  const LoopbackServer server;
  const Readiness ready = readiness(server);
  EXPECT_EQ(ready.status, "200");
  EXPECT_EQ(ready.body, json({{"ready", true}}));
}

TEST(Readiness, AStoreThatDoesNotAnswerIsSaidAndSoIsItsReturn) {
  FaultyDisk disk;
  const rimlight::test::TemporaryFolder folder;
  LoopbackServer::Settings settings;
  settings.store = folder / "s.sqlite";
  settings.store_vfs = FaultyDisk::name();
  const LoopbackServer server(settings);
  const auto client = server.open("a");
  EXPECT_EQ(readiness(server).status, "200");
  disk.fail_flushes();
  ASSERT_TRUE(client->send_text(kEdit));
  const Readiness failing = wait_for(server, "503");
  EXPECT_EQ(failing.status, "503");
  EXPECT_EQ(failing.body, json({{"ready", false}, {"reasons", {"the store does not answer"}}}));
  EXPECT_EQ(test::status_line(test::http(server.port(), "GET", "/healthz")), "HTTP/1.1 200 OK");
  disk.mend();
  EXPECT_EQ(wait_for(server, "200").status, "200");
}

TEST(Readiness, EditsThatAreRefusedByAFullDiskAreSaid) {
  FaultyDisk disk;
  const rimlight::test::TemporaryFolder folder;
  LoopbackServer::Settings settings;
  settings.store = folder / "s.sqlite";
  settings.store_vfs = FaultyDisk::name();
  const LoopbackServer server(settings);
  const auto client = server.open("a");
  disk.fail(0, FaultyDisk::Lasting::once);  // the first write of the commit
  ASSERT_TRUE(client->send_text(kEdit));
  const Readiness failing = wait_for(server, "503");
  ASSERT_EQ(failing.status, "503");
  ASSERT_EQ(failing.body["reasons"].size(), 1u);
  EXPECT_EQ(wait_for(server, "200").body, json({{"ready", true}}));  // it is tried again later
}

}  // namespace
}  // namespace rimlight::server
