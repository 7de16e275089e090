// What changes a session as a whole: an uploaded environment is deleted, the session is, a state of
// any size comes by HTTP. Real sockets.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "server/access/access_token.h"
#include "server/store/environment_folder.h"
#include "server/store/session_tables.h"
#include "tests/server/door_client.h"
#include "tests/server/loopback_server.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

using nlohmann::json;
using rimlight::test::error_of;
using rimlight::test::TemporaryFolder;
using std::chrono::seconds;
using test::LoopbackServer;

constexpr seconds kPatience{20};

struct Answer {
  int status = 0;
  std::string body;
};
Answer request(const LoopbackServer& server, const std::string& method, const std::string& target,
               const std::string& body = "", const std::string& headers = "") {
  std::string bytes =
      method + " " + target + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + headers;
  if (method == "PUT") bytes += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  const std::string text = test::raw(server, bytes + "\r\n" + body);
  if (text.size() < 13) return {};
  return {std::stoi(text.substr(9, 3)), text.substr(text.find("\r\n\r\n") + 4)};
}

/// The next message of the type; null when the connection ended first.
json wait_for(StreamClient& client, const std::string& type) {
  const auto end = Clock::now() + kPatience;
  while (Clock::now() < end) {
    const auto received = client.receive(end);
    if (std::holds_alternative<StreamClient::Closed>(received)) return nullptr;
    const auto* const text = std::get_if<StreamClient::Text>(&received);
    if (text == nullptr) continue;
    json message = json::parse(text->text);
    if (message["type"] == type) return message;
  }
  return nullptr;
}

json ask(StreamClient& client, const json& message, const std::string& type = "ack") {
  EXPECT_TRUE(client.send_text(message.dump()));
  return wait_for(client, type);
}

EnvironmentPtr sky(const std::string& name, float radiance) {
  RgbImage image(6 * 4, 4);
  for (Vec3f& pixel : image.pixels) pixel = Vec3f::filled(radiance);
  return std::make_shared<const Environment>(name, std::move(image), EnvironmentLayout::cube);
}

std::size_t pictures_in(const std::filesystem::path& folder) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    count += entry.path().extension() == ".exr";
  }
  return count;
}

/// A server whose sessions "a" and "b" have uploaded environments.
class SessionChanges : public testing::Test {
 protected:
  SessionChanges() {
    settings.store = folder / "sessions.sqlite";
    settings.uploads = folder / "uploads";
    EnvironmentFolder uploads(settings.uploads, std::uint64_t{1} << 30);
    uploads.add("sphere", "a", *sky("probe", 1));
    uploads.add("sphere", "a", *sky("other", 2));
    uploads.add("sphere", "b", *sky("probe", 1));  // the same picture
  }
  std::string of(const std::string& session, const std::string& environment) const {
    return "/sessions/" + session + "/environments/" + environment;
  }

  TemporaryFolder folder;
  LoopbackServer::Settings settings;
};

TEST_F(SessionChanges, AnEnvironmentThatNothingShowsCanBeDeleted) {
  {
    const LoopbackServer server(settings);
    const auto client = server.open("a");
    ASSERT_EQ(wait_for(*client, "welcome")["environments"],
              json({"day", "night", "probe", "other"}));
    (void)ask(*client, {{"type", "edit"}, {"exposure", 1}});
    (void)ask(*client, {{"type", "edit"}, {"environment", "other"}});
    const Answer shown = request(server, "DELETE", of("a", "other"));
    EXPECT_EQ(shown.status, 409);
    EXPECT_NE(shown.body.find("the session shows"), std::string::npos) << shown.body;
    (void)ask(*client, {{"type", "snapshot"}, {"action", "make"}, {"name", "kept"}});
    (void)ask(*client, {{"type", "edit"}, {"environment", "night"}});
    EXPECT_NE(request(server, "DELETE", of("a", "other")).body.find("kept"), std::string::npos);
    (void)ask(*client, {{"type", "snapshot"}, {"action", "delete"}, {"name", "kept"}});
    EXPECT_EQ(request(server, "DELETE", of("a", "other")).status, 200);
    EXPECT_EQ(wait_for(*client, "environments")["environments"], json({"day", "night", "probe"}));
    EXPECT_EQ(request(server, "DELETE", of("a", "other")).status, 404);
    EXPECT_EQ(request(server, "DELETE", of("a", "day")).status, 404);  // the scene's own
    EXPECT_EQ(pictures_in(settings.uploads), 1u);
    // Steps that would show it again are passed over.
    const json undone = ask(*client, {{"type", "undo"}})["state"];
    EXPECT_EQ(undone["exposure"], 0);
    EXPECT_EQ(undone["environment"], "night");
    EXPECT_EQ(ask(*client, {{"type", "edit"}, {"environment", "other"}}, "error")["where"],
              "message: /environment");
  }
  const LoopbackServer server(settings);  // and it stays away
  EXPECT_EQ(wait_for(*server.open("a"), "welcome")["environments"],
            json({"day", "night", "probe"}));
}

TEST_F(SessionChanges, APictureGoesWithTheLastSessionThatHasIt) {
  const LoopbackServer server(settings);
  EXPECT_EQ(request(server, "DELETE", of("a", "probe")).status, 200);
  EXPECT_EQ(pictures_in(settings.uploads), 2u);
  EXPECT_EQ(request(server, "DELETE", of("b", "probe")).status, 200);
  EXPECT_EQ(pictures_in(settings.uploads), 1u);
}

TEST_F(SessionChanges, WhatNoSessionHasIsCollectedAndNothingElse) {
  EnvironmentFolder uploads(settings.uploads, std::uint64_t{1} << 30);
  EXPECT_EQ(uploads.collect(), 0u);
  std::filesystem::remove(std::filesystem::path(settings.uploads) / "sphere@a.json");
  std::ofstream(std::filesystem::path(settings.uploads) / "notes.exr") << "somebody's own";
  EXPECT_EQ(uploads.collect(), 1u);
  EXPECT_EQ(pictures_in(settings.uploads), 2u);
  EXPECT_EQ(uploads.load("sphere", "b").size(), 1u);
  std::ofstream(std::filesystem::path(settings.uploads) / "sphere@c.json") << "damaged";
  std::filesystem::remove(std::filesystem::path(settings.uploads) / "sphere@b.json");
  EXPECT_EQ(uploads.collect(), 0u);  // it may have named it
}

TEST_F(SessionChanges, AnOwnerDeletesASessionAndAllAreToldAndClosed) {
  {
    const LoopbackServer server(settings);
    const auto owner = server.open("a"), other = server.open("a"), elsewhere = server.open("b");
    (void)ask(*owner, {{"type", "edit"}, {"exposure", 1}});
    const json told = ask(*owner, {{"type", "delete_session"}, {"id", "d"}}, "deleted");
    EXPECT_EQ(told["by"]["name"], "guest 1");
    EXPECT_EQ(wait_for(*other, "deleted"), told);
    for (StreamClient* const client : {owner.get(), other.get()}) {
      EXPECT_TRUE(wait_for(*client, "no such type").is_null());  // until it is closed
    }
    EXPECT_EQ(request(server, "GET", "/sessions/a/state").status, 404);
    const json welcome = wait_for(*server.open("a"), "welcome");  // another of that name
    EXPECT_EQ(welcome["revision"], 0);
    EXPECT_EQ(welcome["environments"], json({"day", "night"}));
    EXPECT_EQ(pictures_in(settings.uploads), 1u);
    EXPECT_EQ(ask(*elsewhere, {{"type", "edit"}, {"exposure", 2}})["revision"], 1);
  }
  EXPECT_EQ(SessionTables({.file = settings.store}).list().size(), 1u);
}

TEST_F(SessionChanges, OnlyOwnersDeleteSessionsAndImportAndOnlyEditorsDeleteEnvironments) {
  settings.network.keys =
      std::make_shared<const SigningKeys>(std::vector<SigningKey>{{"key", std::string(32, 'k')}});
  const LoopbackServer server(settings);
  const auto now = WallClock::now();
  const auto token = [&](Role role) {
    return issue_token({role, "a", "", now + std::chrono::hours(1)}, *settings.network.keys, now);
  };
  const auto bearer = [&](Role role) { return "Authorization: Bearer " + token(role) + "\r\n"; };
  EXPECT_EQ(request(server, "DELETE", of("a", "probe")).status, 401);
  EXPECT_EQ(request(server, "DELETE", of("a", "probe"), "", bearer(Role::viewer)).status, 403);
  EXPECT_EQ(request(server, "DELETE", of("b", "probe"), "", bearer(Role::editor)).status, 403);
  EXPECT_EQ(request(server, "PUT", "/sessions/a/state", "{}", bearer(Role::editor)).status, 403);
  EXPECT_EQ(request(server, "PUT", "/sessions/a/state?token=" + token(Role::owner), "{}").status,
            401);
  EXPECT_EQ(request(server, "PUT", "/sessions/a/state", "{}",
                    bearer(Role::owner) + "Origin: https://evil.example\r\n")
                .status,
            403);
  StreamClient editor({"127.0.0.1", std::to_string(server.port())}, "/sessions/a/stream",
                      {token(Role::editor), {}});
  const json refused = ask(editor, {{"type", "delete_session"}, {"id", "d"}}, "error");
  EXPECT_EQ(refused["id"], "d");
  EXPECT_EQ(request(server, "DELETE", of("a", "probe"), "", bearer(Role::editor)).status, 200);
}

/// As large as a state may be: 64 curves of 256 points, 256 materials with lobes of 64 values.
json largest_state(json state) {
  const std::string tail(40, 'x');
  json parameters, curves;
  for (int i = 0; i < 256; ++i) {
    const std::string name = "material " + std::to_string(i) + tail;
    json lobe = json::array();
    for (int k = 0; k < 64; ++k) lobe.push_back(1 - 0.01234567890123 * k);
    parameters[name] = {{"albedo", {0.123456789, 0.2345678901, 0.345678901}}, {"lobe", lobe}};
    if (i >= 32) continue;
    json points = json::array();
    for (int k = 0; k < 256; ++k) {
      points.push_back({k / 255.0, 0.123456789 + k, 0.2345678901 + k, 0.345678901 + k});
    }
    const json curve{{"scale", "linear"}, {"points", points}};
    curves[name] = {{"half_angle", curve}, {"difference_angle", curve}};
  }
  state["material"] = {{"parameter", parameters}, {"curve", curves}, {"load", json::object()}};
  return state;
}

TEST_F(SessionChanges, TheLargestStateGoesOutAndInAgain) {
  const LoopbackServer server(settings);
  const auto client = server.open("a");
  const json welcome = wait_for(*client, "welcome");
  (void)ask(*client, {{"type", "edit"}, {"exposure", 1}});
  json file = json::parse(request(server, "GET", "/sessions/a/state").body);
  file["state"] = largest_state(file["state"]);
  ASSERT_GT(file.dump().size(), std::size_t{1} << 20);
  const std::string as_user = "/sessions/a/state?resume=" + welcome["resume"].get<std::string>();
  const Answer imported = request(server, "PUT", as_user, file.dump());
  ASSERT_EQ(imported.status, 200) << imported.body;
  const json ack = json::parse(imported.body);
  EXPECT_EQ(ack["revision"], 2);
  EXPECT_EQ(ack["by"], welcome["you"].contains("id")
                           ? json({{"id", welcome["you"]["id"]}, {"name", welcome["you"]["name"]}})
                           : json());
  const std::string exported = request(server, "GET", "/sessions/a/state").body;
  EXPECT_GT(exported.size(), std::size_t{1} << 20);
  const Answer again = request(server, "PUT", "/sessions/b/state", exported);
  ASSERT_EQ(again.status, 200) << again.body;
  const json copy = json::parse(request(server, "GET", "/sessions/b/state").body);
  EXPECT_EQ(copy["state"], json::parse(exported)["state"]);
  EXPECT_EQ(copy["state"]["material"]["curve"].size(), 32u);
  // It was the user's own step.
  EXPECT_EQ(ask(*client, {{"type", "undo"}})["state"]["material"]["curve"], json::object());
}

TEST_F(SessionChanges, AnImportThatCannotBeIsRefusedWithTheReason) {
  const LoopbackServer server(settings);
  const auto client = server.open("a");
  (void)wait_for(*client, "welcome");
  const json file = json::parse(request(server, "GET", "/sessions/a/state").body);
  const std::string target = "/sessions/a/state";
  json wrong = file;
  wrong["state"]["environment"] = "gone";
  EXPECT_NE(request(server, "PUT", target, wrong.dump()).body.find("gone"), std::string::npos);
  EXPECT_EQ(request(server, "PUT", target, wrong.dump()).status, 422);
  EXPECT_EQ(request(server, "PUT", target, "no json").status, 422);
  EXPECT_EQ(request(server, "PUT", target, "{}").status, 422);
  EXPECT_EQ(request(server, "PUT", "/sessions/a/state?scene=none", file.dump()).status, 404);
  EXPECT_EQ(request(server, "PUT", "/sessions/a%20b/state", file.dump()).status, 404);
  const std::string header = "PUT " + target + " HTTP/1.1\r\nHost: localhost\r\n";
  const auto status = [&](const std::string& more) {
    return test::status_line(test::raw(server, header + more)).substr(9, 3);
  };
  EXPECT_EQ(status("Content-Length: 4194305\r\n\r\n"), "413");
  EXPECT_EQ(status("Transfer-Encoding: chunked\r\n\r\n"), "411");
  EXPECT_EQ(json::parse(request(server, "GET", target).body)["revision"], 0);
}

}  // namespace
}  // namespace rimlight::server
