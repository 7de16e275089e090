// Uploads of environments over a real socket, decoded by the real program in a child process.
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/resource.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "core/base/files.h"
#include "core/image/image_file.h"
#include "server/access/access_token.h"
#include "server/session/session_environments.h"
#include "server/upload/child_process.h"
#include "server/upload/decoded_environment.h"
#include "tests/server/door_client.h"
#include "tests/server/loopback_server.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

using nlohmann::json;
using rimlight::test::error_of;
using rimlight::test::TemporaryFolder;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::LoopbackServer;
using test::RawSocket;
using test::status_line;

constexpr seconds kPatience{10};
const DecoderSettings kDecoder{{RIMLIGHT_PROGRAM, "decode-environment"}, seconds(60)};

LoopbackServer::Settings with_decoder() {
  LoopbackServer::Settings settings;
  settings.network.decoder = kDecoder;
  return settings;
}

/// A sky of one radiance with one bright pixel, as the bytes of an .exr file.
std::string exr_of(const Vec3f& sky, const Vec3f& sun) {
  const TemporaryFolder folder;
  RgbImage image(64, 32);
  for (Vec3f& pixel : image.pixels) pixel = sky;
  image.at(20, 8) = sun;
  write_exr(folder / "sky.exr", image);
  return read_file(folder / "sky.exr", kLargestUpload);
}

/// Radiance RGBE, flat: four bytes a pixel.
std::string hdr_of(int width, int height, const std::string& pixel) {
  std::string bytes = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) +
                      " +X " + std::to_string(width) + "\n";
  for (int i = 0; i < width * height; ++i) bytes += pixel;
  return bytes;
}

std::string request_of(const std::string& target, std::size_t size,
                       const std::string& headers = "") {
  return "POST " + target + " HTTP/1.1\r\nHost: localhost\r\n" + headers +
         "Content-Length: " + std::to_string(size) + "\r\n\r\n";
}

std::string upload(const LoopbackServer& server, const std::string& name, const std::string& bytes,
                   const std::string& headers = "") {
  return test::raw(server,
                   request_of("/sessions/a/environments/" + name, bytes.size(), headers) + bytes);
}

int status_of(const std::string& answer) {
  return answer.size() > 12 ? std::stoi(answer.substr(9, 3)) : 0;
}
std::string reason_of(const std::string& answer) {
  return json::parse(answer.substr(answer.find("\r\n\r\n") + 4)).value("reason", "");
}

json wait_for(StreamClient& client, const std::string& type) {
  const auto end = Clock::now() + kPatience;
  while (Clock::now() < end) {
    const auto received = client.receive(end);
    if (std::holds_alternative<StreamClient::Closed>(received)) return nullptr;
    const auto* const text = std::get_if<StreamClient::Text>(&received);
    if (text != nullptr && json::parse(text->text)["type"] == type) return json::parse(text->text);
  }
  return nullptr;
}

TEST(Upload, BothFormatsKeepTheirRadianceAndWhereItComesFrom) {
  const Vec3f sky{0.25f, 0.5f, 1}, sun{4000, 3000, 2000};
  const auto environment = decode_uploaded("sky", exr_of(sky, sun), kDecoder);
  EXPECT_EQ(environment->name(), "sky");
  EXPECT_EQ(environment->layout(), EnvironmentLayout::cube);
  const TemporaryFolder folder;
  std::ofstream(folder / "sky.exr") << exr_of(sky, sun);
  const Environment direct = load_environment(folder / "sky.exr");
  const Vec3d expected = integral(direct), got = integral(*environment);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c] / expected[c], 1, 2e-3);
  const CubeLight a = direct.project(8), b = environment->project(8);
  const auto brightest = [](const CubeLight& light) {
    return std::ranges::max_element(light.channel(0)) - light.channel(0).begin();
  };
  EXPECT_EQ(brightest(a), brightest(b));  // the sun stands where it stood
  EXPECT_NEAR(a.values[static_cast<std::size_t>(brightest(a))] /
                  b.values[static_cast<std::size_t>(brightest(a))],
              1, 0.05);
  const auto grey = decode_uploaded("grey", hdr_of(64, 32, "\x80\x80\x80\x81"), kDecoder);
  EXPECT_NEAR(grey->image().at(100, 100).x, 1, 0.02);
}

TEST(Upload, AllClientsAreToldAndEditsMayNameItAndFramesComeOfIt) {
  LoopbackServer server(with_decoder());
  const auto client = server.open("a"), other = server.open("a");
  EXPECT_FALSE(wait_for(*other, "welcome").is_null());
  const std::string answer = upload(server, "probe", exr_of({1, 1, 1}, {9, 9, 9}));
  EXPECT_EQ(status_of(answer), 201) << answer;
  const json told = wait_for(*other, "environments");
  EXPECT_EQ(told["environments"], (json{"day", "night", "probe"}));
  ASSERT_TRUE(client->send_text(R"({"type":"edit","id":"e","environment":"probe"})"));
  EXPECT_EQ(wait_for(*client, "ack")["state"]["environment"], "probe");
  const auto end = Clock::now() + kPatience;
  while (server.probe().added_environments == 0 && Clock::now() < end) {
    (void)client->receive(Clock::now() + milliseconds(20));
  }
  EXPECT_EQ(server.probe().added_environments, 1);
  const auto late = server.open("a");
  EXPECT_EQ(wait_for(*late, "welcome")["environments"], (json{"day", "night", "probe"}));
  EXPECT_EQ(status_of(upload(server, "probe", exr_of({1, 1, 1}, {9, 9, 9}))), 409);
  EXPECT_EQ(status_of(upload(server, "day", exr_of({1, 1, 1}, {9, 9, 9}))), 409);
}

/// Sends a command and waits for what answers it: its ack, or an error.
json answer_to(StreamClient& client, json command) {
  const std::string id = command["type"].get<std::string>() + command.value("name", "");
  command["id"] = id;
  EXPECT_TRUE(client.send_text(command.dump()));
  const auto end = Clock::now() + kPatience;
  while (Clock::now() < end) {
    const auto received = client.receive(end);
    if (std::holds_alternative<StreamClient::Closed>(received)) return nullptr;
    const auto* const text = std::get_if<StreamClient::Text>(&received);
    if (text == nullptr) continue;
    json message = json::parse(text->text);
    if (message.value("id", "") == id) return message;
  }
  return nullptr;
}

TEST(Upload, UndoSnapshotsAndImportsTreatItsNameLikeAnyOther) {
  LoopbackServer server(with_decoder());
  const auto client = server.open("a");
  ASSERT_EQ(status_of(upload(server, "probe", exr_of({1, 1, 1}, {9, 9, 9}))), 201);
  const auto shown = [&](const json& command) {
    const json answer = answer_to(*client, command);
    return answer.value("/state/environment"_json_pointer, answer.value("reason", "nothing"));
  };
  EXPECT_EQ(shown({{"type", "edit"}, {"environment", "probe"}}), "probe");
  EXPECT_EQ(shown({{"type", "snapshot"}, {"action", "make"}, {"name", "kept"}}), "probe");
  json state = answer_to(*client, {{"type", "edit"}, {"exposure", 1}})["state"];
  EXPECT_EQ(shown({{"type", "edit"}, {"environment", "night"}}), "night");
  EXPECT_EQ(shown({{"type", "undo"}}), "probe");
  EXPECT_EQ(shown({{"type", "redo"}}), "night");
  EXPECT_EQ(shown({{"type", "snapshot"}, {"action", "restore"}, {"name", "kept"}}), "probe");
  EXPECT_EQ(shown({{"type", "edit"}, {"environment", "day"}}), "day");
  EXPECT_EQ(shown({{"type", "import"}, {"state", state}}), "probe");
  state["environment"] = "gone";
  EXPECT_NE(shown({{"type", "import"}, {"state", state}}).find("gone"), std::string::npos);
  const auto other = server.open("b");  // has none
  state["environment"] = "probe";
  const json refused = answer_to(*other, {{"type", "import"}, {"state", state}});
  EXPECT_NE(refused.value("reason", "").find("probe"), std::string::npos) << refused;
}

TEST(Upload, ARestartKeepsThemAndASessionThatShowsOne) {
  const TemporaryFolder folder;
  LoopbackServer::Settings settings = with_decoder();
  settings.store = folder / "sessions.sqlite";
  settings.uploads = folder / "uploads";
  {
    const LoopbackServer server(settings);
    ASSERT_EQ(status_of(upload(server, "probe", exr_of({1, 1, 1}, {9, 9, 9}))), 201);
    const auto client = server.open("a");
    ASSERT_TRUE(client->send_text(R"({"type":"edit","id":"e","environment":"probe"})"));
    ASSERT_FALSE(wait_for(*client, "ack").is_null());
  }
  {
    const LoopbackServer server(settings);
    const json welcome = wait_for(*server.open("a"), "welcome");
    EXPECT_EQ(welcome["environments"], (json{"day", "night", "probe"}));
    EXPECT_EQ(welcome["state"]["environment"], "probe");
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder / "uploads")) {
    if (entry.path().extension() == ".exr") std::ofstream(entry.path()) << "damaged";
  }
  const LoopbackServer server(settings);  // the session says why it cannot be shown
  EXPECT_NE(error_of([&] { server.open("a"); }).find("probe"), std::string::npos);
}

TEST(Upload, WhoMayNotIsRefusedBeforeABodyIsRead) {
  LoopbackServer::Settings settings = with_decoder();
  settings.network.keys =
      std::make_shared<const SigningKeys>(std::vector<SigningKey>{{"key", std::string(32, 'k')}});
  const LoopbackServer server(settings);
  const auto now = WallClock::now();
  const auto token = [&](Role role, const std::string& session) {
    return issue_token({role, session, "", now + std::chrono::hours(1)}, *settings.network.keys,
                       now);
  };
  const auto status = [&](const std::string& target, const std::string& headers,
                          std::size_t size = 1000) {
    RawSocket socket(server.port());
    socket.send(request_of(target, size, headers));  // and no body
    return status_of(socket.read_some());
  };
  const auto bearer = [&](Role role, const std::string& session) {
    return "Authorization: Bearer " + token(role, session) + "\r\n";
  };
  const std::string target = "/sessions/a/environments/x";
  EXPECT_EQ(status(target, ""), 401);
  EXPECT_EQ(status(target + "?token=" + token(Role::editor, "a"), ""), 404);
  EXPECT_EQ(status(target, bearer(Role::viewer, "a")), 403);
  EXPECT_EQ(status(target, bearer(Role::editor, "b")), 403);
  EXPECT_EQ(status(target, bearer(Role::editor, "a") + "Origin: https://evil.example\r\n"), 403);
  EXPECT_EQ(status(target, bearer(Role::editor, "a"), (32 << 20) + 1), 413);
  EXPECT_EQ(status(target + "?scene=none", bearer(Role::editor, "a")), 404);
  EXPECT_EQ(status("/sessions/a/environments/..%2fx", bearer(Role::editor, "a")), 404);
  EXPECT_EQ(status("/sessions/a/environments/a/b", bearer(Role::editor, "a")), 404);
  const std::string chunked = "POST " + target + " HTTP/1.1\r\nHost: localhost\r\n" +
                              bearer(Role::editor, "a") + "Transfer-Encoding: chunked\r\n\r\n";
  RawSocket socket(server.port());
  socket.send(chunked);
  EXPECT_EQ(status_of(socket.read_some()), 411);
  EXPECT_EQ(status_of(upload(server, "x", exr_of({1, 1, 1}, {2, 2, 2}),
                             bearer(Role::editor, "a") + "Expect: 100-continue\r\n")),
            100);
  EXPECT_EQ(status_of(upload(server, "x", exr_of({1, 1, 1}, {2, 2, 2}), bearer(Role::owner, "a"))),
            409);  // it is there now
}

TEST(Upload, ABodyThatComesTooSlowlyEndsTheConnection) {
  LoopbackServer::Settings settings = with_decoder();
  settings.network.handshake_timeout = seconds(1);
  const LoopbackServer server(settings);
  RawSocket socket(server.port());
  const auto start = Clock::now();
  socket.send(request_of("/sessions/a/environments/x", 1000) + "#?RADIANCE");
  for (int i = 0; i < 15; ++i) {
    socket.send("x");
    std::this_thread::sleep_for(milliseconds(100));
  }
  EXPECT_EQ(socket.read_all(), "");
  EXPECT_LT(Clock::now() - start, seconds(4));
}

TEST(Upload, ASessionHasNoMoreThanItsUploads) {
  SessionEnvironments environments({"day"}, {});
  const auto add = [&](const std::string& name) {
    return error_of(
        [&] { environments.add(std::make_shared<const Environment>(name, RgbImage(2, 1))); });
  };
  for (std::size_t i = 0; i < kMostUploads; ++i) {
    EXPECT_NE(add("day").find("another name"), std::string::npos);
    EXPECT_EQ(add("e" + std::to_string(i)), "no error");
    EXPECT_NE(add("e0").find("another name"), std::string::npos);
  }
  EXPECT_NE(add("more").find("16 uploaded"), std::string::npos);
  EXPECT_EQ(environments.names().size(), kMostUploads + 1);
  EXPECT_NE(environments.find_uploaded("e3"), nullptr);
  EXPECT_EQ(environments.find_uploaded("day"), nullptr);
}

/// Of this process' largest memory so far, in MiB.
long peak_mebibytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

TEST(Upload, WhatCannotBeDecodedIsRefusedWithAReasonAndTheServerLives) {
  const LoopbackServer server(with_decoder());
  const std::string exr = exr_of({1, 1, 1}, {2, 2, 2});
  std::mt19937 random(7);
  const auto noise = [&](std::size_t size) {
    std::string bytes(size, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    return bytes;
  };
  std::string flipped = exr;
  for (std::size_t i = 8; i < 300; i += 7) flipped[i] = static_cast<char>(~flipped[i]);
  std::string bomb = exr;  // of a data window of two thousand million pixels a side
  const std::size_t window =
      bomb.find("dataWindow") + std::string("dataWindow\0box2i\0....", 21).size();
  bomb.replace(window + 8, 8, "\xff\xff\xff\x7f\xff\xff\xff\x7f", 8);
  upload(server, "warm", exr);
  const long before = peak_mebibytes();
  for (const std::string& bytes :
       {std::string("x"), noise(5000), "#?RADIANCE\n" + noise(5000),
        std::string("\x76\x2f\x31\x01", 4) + noise(5000), exr.substr(0, exr.size() / 2),
        exr.substr(0, 20), flipped, bomb, hdr_of(4, 2, "\x80").substr(0, 60),
        std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 999999 +X 999999\n"),
        std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16384 +X 16384\n\2\2\x40\0")}) {
    const std::string answer = upload(server, "bad", bytes);
    EXPECT_EQ(status_of(answer), 422) << answer;
    EXPECT_GT(reason_of(answer).size(), 10u) << answer;
  }
  EXPECT_LT(peak_mebibytes() - before, 64);
  EXPECT_EQ(status_of(upload(server, "good", exr)), 201);
}

TEST(Upload, ADecoderThatHangsDiesOrLiesIsAnErrorInTime) {
  const auto refusal = [](std::vector<std::string> command) {
    return error_of([&] {
      decode_uploaded("x", hdr_of(2, 2, "\x80\x80\x80\x81"),
                      {std::move(command), milliseconds(500)});
    });
  };
  const auto start = Clock::now();
  EXPECT_NE(refusal({"/bin/sleep", "100"}).find("too long"), std::string::npos);
  EXPECT_LT(Clock::now() - start, seconds(5));
  EXPECT_NE(refusal({"/bin/sh", "-c", "kill -9 $$"}).find("time or memory"), std::string::npos);
  EXPECT_NE(refusal({"/bin/sh", "-c", "echo no; exit 0"}).find("failed"), std::string::npos);
  EXPECT_NE(refusal({"/bin/cat", "/dev/zero"}).find("failed"), std::string::npos);
  EXPECT_NE(
      refusal({"/bin/sh", "-c", "cat >/dev/null; echo it burns >&2; exit 1"}).find("it burns"),
      std::string::npos);
  EXPECT_NE(refusal({"/no/such/program"}).find("/no/such/program"), std::string::npos);
  // Floats that are none: the child is not believed.
  EXPECT_NE(refusal({"/bin/sh", "-c", "head -c 4718592 /dev/zero | tr '\\0' '\\377'"}).find("nan"),
            std::string::npos);
}

TEST(Upload, AChildHasNoDescriptorsAndNoEnvironmentOfItsParent) {
  const std::ofstream open("/dev/null");
  const ChildResult result =
      run_child({{"/bin/sh", "-c", "ls /proc/self/fd | wc -l; env"}, seconds(5), 4096}, "");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.output.substr(0, 2), "4\n");  // the three, and the one that ls reads the list by
  EXPECT_EQ(result.output.find("PATH="), std::string::npos) << result.output;
}

}  // namespace
}  // namespace rimlight::server
