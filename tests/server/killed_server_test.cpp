// `rimlight serve --store` killed with SIGKILL in the middle of edits, at any time and before, in
// and after what it writes, flushes and acknowledges: every edit that was acknowledged is there
// after a restart, and the state is that of a whole revision.
#include <gtest/gtest.h>
#include <signal.h>  // NOLINT: SIGKILL is POSIX

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <thread>

#include "cli/load_stream.h"
#include "core/image/image_file.h"
#include "tests/support/killed_program.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

namespace test = rimlight::test;

using nlohmann::json;
using std::chrono::seconds;
using test::KillPoint;
using test::RunningProgram;
using Clock = StreamClient::Clock;

constexpr seconds kPatience{20};
/// Edits that a client has on their way at most.
constexpr std::int64_t kAhead = 40;

constexpr const char* kScene = R"({ "name": "ball",
  "camera": { "position": [0, 1.5, 4], "target": [0, 0.5, 0], "field_of_view": 35 },
  "materials": { "clay": { "model": "lambert", "albedo": [0.7, 0.5, 0.4] } },
  "objects": [ { "shape": "sphere", "radius": 0.6, "translate": [0, 0.6, 0], "material": "clay" } ],
  "environments": [{ "file": "grey.exr", "name": "grey" }],
  "bake": { "width": 32, "height": 32, "cube_size": 8, "bounces": 0, "psnr_db": 30,
            "primary_rays": 1 } })";

/// The exposure that the edit of a revision sets: another for each.
double exposure_of(std::int64_t revision) { return static_cast<double>(revision % 16384) / 1024; }

std::string edit_of(std::int64_t revision) {
  return json{
      {"type", "edit"}, {"id", std::to_string(revision)}, {"exposure", exposure_of(revision)}}
      .dump();
}

class KilledServer : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder / "ball.json") << kScene;
    RgbImage grey(32, 16);
    for (Vec3f& pixel : grey.pixels) pixel = {1, 1, 1};
    write_exr(folder / "grey.exr", grey);
    std::filesystem::create_directories(folder / "store");
    const auto baked =
        test::run_program({"bake", (folder / "ball.json").string(), "-o", bake().string()});
    ASSERT_EQ(baked.status, 0) << baked.errors;
  }
  std::filesystem::path bake() const { return folder / "ball.bake"; }

  /// Starts the server and waits for its address; false when it was killed before.
  bool start(const std::optional<KillPoint>& point = {}) {
    const std::vector<std::string> command{"serve",
                                           bake().string(),
                                           "--port",
                                           "0",
                                           "--json",
                                           "--store",
                                           (folder / "store" / "sessions.sqlite").string()};
    server = point ? std::make_unique<RunningProgram>("env", program.killed(*point, command))
                   : std::make_unique<RunningProgram>(command);
    const Clock::time_point end = Clock::now() + kPatience;
    while (server->output().find('\n') == std::string::npos) {
      if (!server->is_running() || Clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    std::string address = json::parse(server->output())["address"];  // http://HOST:PORT/
    address.pop_back();
    url = parse_stream_url("ws" + address.substr(4));
    return true;
  }
  /// Opens the session, as the user that it was before; its welcome, or null.
  json open() {
    const std::string query = resume.empty() ? "" : "?resume=" + resume;
    stream = std::make_unique<StreamClient>(url, "/sessions/a/stream" + query);
    const StreamClient::Received first = stream->receive(Clock::now() + kPatience);
    const auto* const text = std::get_if<StreamClient::Text>(&first);
    return text == nullptr ? json() : json::parse(text->text);
  }
  /// Edits until the connection breaks, and notes what was acknowledged.
  void edit_until_killed() {
    for (std::int64_t sent = acknowledged;;) {
      if (sent < acknowledged + kAhead && stream->send_text(edit_of(sent + 1))) ++sent;
      const auto received = stream->receive(Clock::now() + std::chrono::microseconds(200));
      if (std::holds_alternative<StreamClient::Closed>(received)) return;
      if (const auto* const text = std::get_if<StreamClient::Text>(&received)) {
        const json message = json::parse(text->text);
        EXPECT_EQ(message["type"], "ack") << text->text;
        EXPECT_EQ(message["revision"], acknowledged + 1);
        EXPECT_EQ(message["state"]["exposure"], exposure_of(acknowledged + 1));
        ++acknowledged;
      }
    }
  }
  /// Opens the session again and holds it to what was acknowledged. Its revision.
  void come_back() {
    const Clock::time_point came = Clock::now();
    const json welcome = open();
    ASSERT_TRUE(welcome.is_object());
    revision = welcome["revision"].get<std::int64_t>();
    ASSERT_TRUE(std::holds_alternative<StreamClient::Binary>(stream->receive(came + kPatience)));
    const std::chrono::duration<double, std::milli> took = Clock::now() - came;
    slowest_ms = std::max(slowest_ms, took.count());
    // A user is kept with the first edit.
    ASSERT_EQ(welcome["resumed"], revision > 0);
    resume = welcome["resume"];
    ASSERT_EQ(welcome["history"]["undo"], std::min<std::int64_t>(revision, 100));
    ASSERT_GE(revision, acknowledged) << "an acknowledged edit is lost";
    ASSERT_LE(revision, acknowledged + kAhead);
    ASSERT_EQ(welcome["state"]["exposure"], exposure_of(revision));
    ASSERT_GT(welcome["epoch"].get<std::int64_t>(), epoch);
    epoch = welcome["epoch"];
    beyond += revision - acknowledged;
    acknowledged = revision;
  }
  void expect_that_it_undoes() {
    ASSERT_TRUE(stream->send_text(R"({"type": "undo", "id": "u"})"));
    const auto answer = stream->receive(Clock::now() + kPatience);
    ASSERT_TRUE(std::holds_alternative<StreamClient::Text>(answer));
    const json undone = json::parse(std::get<StreamClient::Text>(answer).text);
    EXPECT_EQ(undone["state"]["exposure"], exposure_of(revision - 1));
  }
  void report(int kills) const {
    std::printf(
        "%d kills, %d edits acknowledged, %d more were durable; first frame within %.0f ms\n",
        kills, static_cast<int>(acknowledged - beyond), static_cast<int>(beyond), slowest_ms);
    EXPECT_LT(slowest_ms, 1000);
    EXPECT_GT(acknowledged, kills);
  }

  test::TemporaryFolder folder;
  const test::WatchedProgram program{folder / "store"};
  std::unique_ptr<RunningProgram> server;
  StreamUrl url;
  std::unique_ptr<StreamClient> stream;
  std::string resume;  // token
  std::int64_t revision = 0, acknowledged = 0, beyond = 0, epoch = 0;
  double slowest_ms = 0;
};

/// Half of them are named.
int points() {
  const char* const asked = std::getenv("RIMLIGHT_KILL_POINTS");
  return asked == nullptr ? 16 : std::atoi(asked);
}

TEST_F(KilledServer, AtAnyTimeHasEveryAcknowledgedEditWhenItComesBack) {
  std::mt19937 random(20260101);
  std::uniform_int_distribution<int> microseconds(500, 80'000);
  const int kills = points() / 2;
  ASSERT_GT(kills, 0);
  for (int i = 0; i <= kills; ++i) {
    SCOPED_TRACE("kill " + std::to_string(i));
    ASSERT_TRUE(start()) << server->wait().errors;
    ASSERT_NO_FATAL_FAILURE(come_back());
    if (i == kills) break;
    std::jthread killer([this, delay = std::chrono::microseconds(microseconds(random))] {
      std::this_thread::sleep_for(delay);
      server->kill();
    });
    edit_until_killed();
  }
  expect_that_it_undoes();
  report(kills);
}

TEST_F(KilledServer, AtNamedOperationsHasEveryAcknowledgedEditWhenItComesBack) {
  using Phase = KillPoint::Phase;
  const std::vector<std::pair<const char*, Phase>> names = {
      {"write", Phase::before},      {"write", Phase::half},  {"write", Phase::after},
      {"fsync", Phase::before},      {"fsync", Phase::after}, {"acknowledge", Phase::before},
      {"acknowledge", Phase::after},
  };
  std::mt19937 random(20260103);
  std::uniform_int_distribution<long> numbers(0, 40);
  const int kills = points() - points() / 2;
  int at_start = 0;
  for (int i = 0; i < kills; ++i) {
    const auto [kind, phase] = names[static_cast<std::size_t>(i) % names.size()];
    const KillPoint point{.number = numbers(random), .kind = kind, .phase = phase};
    SCOPED_TRACE(std::string(to_string(phase)) + " " + kind + " " + std::to_string(point.number));
    if (start(point)) {
      ASSERT_NO_FATAL_FAILURE(come_back());
      edit_until_killed();
    } else {
      ++at_start;
    }
    ASSERT_EQ(server->wait().status, 128 + SIGKILL);
    const auto last = program.operations();
    ASSERT_EQ(last.size(), 1u);
    EXPECT_EQ(last[0].kind, kind);
  }
  ASSERT_TRUE(start()) << server->wait().errors;
  ASSERT_NO_FATAL_FAILURE(come_back());
  expect_that_it_undoes();
  report(kills);
  EXPECT_LT(at_start, kills);
}

TEST_F(KilledServer, DoesNotStartWithAStoreThatItCannotRead) {
  std::ofstream(folder / "not.sqlite") << "a letter, of more than the sixteen bytes of a header";
  const auto by_option =
      test::run_program({"serve", bake().string(), "--store", (folder / "not.sqlite").string()});
  EXPECT_EQ(by_option.status, 1);
  EXPECT_NE(by_option.errors.find("not.sqlite: found"), std::string::npos) << by_option.errors;
  std::ofstream(folder / "server.json") << R"({ "bakes": ["ball.bake"], "store": "not.sqlite" })";
  const auto by_file = test::run_program({"serve", "--config", (folder / "server.json").string()});
  EXPECT_EQ(by_file.status, 1);
  EXPECT_NE(by_file.errors.find((folder / "not.sqlite").string()), std::string::npos)
      << by_file.errors;
}

}  // namespace
}  // namespace rimlight::server
