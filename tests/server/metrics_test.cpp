// What /metrics says: its form, and that each number is what happened.
#include "server/metrics/server_metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <thread>

#include "core/base/files.h"
#include "server/access/access_token.h"
#include "server/store/sqlite_store.h"
#include "tests/server/design_session_case.h"
#include "tests/server/door_client.h"
#include "tests/server/metrics_text.h"
#include "tests/server/stored_edits.h"
#include "tests/support/allocation_count.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

using rimlight::test::error_of;
using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::LoopbackServer;
using test::MetricsText;
using test::parse_metrics;

MetricsText read(const ServerMetrics& metrics) { return parse_metrics(metrics.to_text()); }

TEST(Metrics, TheTestsReaderRefusesWhatTheFormatDoes) {
  const auto fault = [](const std::string& text) {
    return error_of([&] { (void)parse_metrics(text); });
  };
  const std::string head = "# HELP a_total x\n# TYPE a_total counter\n";
  EXPECT_EQ(fault(head + "a_total{b=\"c\\n\"} 1\n"), "no error");
  EXPECT_NE(fault(head + "a_total 1"), "no error");
  EXPECT_NE(fault(head + "a_total -1\n"), "no error");
  EXPECT_NE(fault(head + "a_total x\n"), "no error");
  EXPECT_NE(fault(head + "a_total 1\na_total 1\n"), "no error");
  EXPECT_NE(fault(head + "b_total 1\n"), "no error");
  EXPECT_NE(fault(head + "a_total{b=c} 1\n"), "no error");
  EXPECT_NE(fault("# TYPE a_total counter\na_total 1\n"), "no error");
  EXPECT_NE(fault("# HELP a x\n# TYPE a counter\na 1\n"), "no error");
  const std::string histogram = "# HELP h x\n# TYPE h histogram\n";
  EXPECT_EQ(
      fault(histogram + "h_count 2\nh_sum 1\nh_bucket{le=\"1\"} 1\nh_bucket{le=\"+Inf\"} 2\n"),
      "no error");
  EXPECT_NE(
      fault(histogram + "h_count 3\nh_sum 1\nh_bucket{le=\"1\"} 1\nh_bucket{le=\"+Inf\"} 2\n"),
      "no error");
  EXPECT_NE(
      fault(histogram + "h_count 2\nh_sum 1\nh_bucket{le=\"1\"} 3\nh_bucket{le=\"+Inf\"} 2\n"),
      "no error");
  EXPECT_NE(fault(histogram + "h_count 2\nh_sum 1\nh_bucket{le=\"1\"} 2\n"), "no error");
}

TEST(Metrics, EveryFamilyIsThereFromTheStartAndBounded) {
  const ServerMetrics metrics;
  const MetricsText text = read(metrics);
  EXPECT_GE(text.types.size(), 30u);
  EXPECT_LT(text.samples.size(), 400u);
  for (const RefusalReason reason : kRefusalReasons) {
    EXPECT_EQ(text.at(std::string("rimlight_refusals_total{reason=\"") + to_string(reason) + "\"}"),
              0);
  }
  for (const CloseReason reason : kCloseReasons) {
    EXPECT_EQ(text.at(std::string("rimlight_connections_closed_total{outcome=\"") +
                      to_string(reason) + "\"}"),
              0);
  }
}

TEST(Metrics, AreAllInTheDocument) {
  const std::string document = read_file("docs/operations.md", std::size_t{1} << 20);
  const MetricsText text = read(ServerMetrics{});
  ASSERT_FALSE(text.types.empty());
  for (const auto& [name, type] : text.types) {
    EXPECT_NE(document.find("`" + name + "`"), std::string::npos) << name;
  }
  static const std::regex named("`((?:rimlight|process)_[a-z_]+)`");
  for (std::sregex_iterator found(document.begin(), document.end(), named), end; found != end;
       ++found) {
    EXPECT_TRUE(text.types.contains((*found)[1])) << (*found)[1];
  }
}

TEST(Metrics, SayWhatTheProcessUses) {
  const ServerMetrics metrics;
  const double before = read(metrics).at("process_resident_memory_bytes");
  EXPECT_GT(before, 1e6);
  const std::vector<char> more(std::size_t{64} << 20, 'x');
  const MetricsText text = read(metrics);
  EXPECT_NEAR(text.at("process_resident_memory_bytes") - before, static_cast<double>(more.size()),
              8e6);
  // Looked at, or a compiler may leave it out.
  EXPECT_EQ(std::ranges::count(more, 'x'), static_cast<std::ptrdiff_t>(more.size()));
  EXPECT_GT(text.at("process_open_fds"), 2);
  EXPECT_GT(text.at("process_cpu_seconds_total"), 0);
  const double now =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  EXPECT_LT(text.at("process_start_time_seconds"), now + 2);
  EXPECT_GT(text.at("process_start_time_seconds"), now - 3600);
}

TEST(Metrics, CountingAFrameAllocatesNothing) {
  if (!rimlight::test::kCountsAllocations) GTEST_SKIP();
  ServerMetrics metrics;
  FrameHeader header;
  const std::size_t before = rimlight::test::allocation_count();
  for (int i = 0; i < 1000; ++i) {
    header.exact = i % 2 == 0;
    header.codec = header.exact ? Codec::png : Codec::jpeg;
    metrics.frame_drawn(header);
    metrics.frame_made(header);
    metrics.edit_shown(ServerMetrics::FrameKind::moving, milliseconds(i));
    metrics.sent(ServerMetrics::Content::frame, 1000);
    metrics.received(100);
  }
  EXPECT_EQ(rimlight::test::allocation_count(), before);
  EXPECT_EQ(read(metrics).at("rimlight_queue_age_seconds_count{kind=\"exact\"}"), 500);
}

class SessionMetrics : public test::DesignSessionTest {
 protected:
  SessionMetrics() {
    session =
        std::make_shared<DesignSession>("s", scene, 5, SessionSettings{.metrics = metrics}, queue);
  }
  double value(const std::string& sample) const { return read(*metrics).at(sample); }

  std::shared_ptr<ServerMetrics> metrics = std::make_shared<ServerMetrics>();
};

TEST_F(SessionMetrics, FramesAndTheLatencyOfEditsAreWhatHappened) {
  const auto client = join();
  work();  // the first exact frame shows no edit
  acknowledge(*client);
  edit(*client, 10);
  now += milliseconds(3);
  edit(*client, 20);
  pass(milliseconds(4));  // a frame in motion, 7 ms after the older edit
  acknowledge(*client);
  pass(milliseconds(46));  // the exact one, 50 ms after the newer edit
  acknowledge(*client);
  EXPECT_EQ(value("rimlight_sessions"), 1);
  EXPECT_EQ(value("rimlight_edits_total"), 2);
  EXPECT_EQ(value("rimlight_frames_total{codec=\"png\",kind=\"exact\"}"), 2);
  EXPECT_EQ(value("rimlight_frames_total{codec=\"jpeg\",kind=\"moving\"}"), 1);
  EXPECT_EQ(value("rimlight_edit_to_frame_seconds_count{kind=\"moving\"}"), 1);
  EXPECT_NEAR(value("rimlight_edit_to_frame_seconds_sum{kind=\"moving\"}"), 0.007, 1e-9);
  EXPECT_EQ(value("rimlight_edit_to_frame_seconds_count{kind=\"exact\"}"), 1);
  EXPECT_NEAR(value("rimlight_edit_to_frame_seconds_sum{kind=\"exact\"}"), 0.050, 1e-9);
  EXPECT_EQ(value("rimlight_edit_to_frame_seconds_bucket{kind=\"exact\",le=\"0.05\"}"), 1);
  EXPECT_EQ(value("rimlight_edit_to_frame_seconds_bucket{kind=\"exact\",le=\"0.0333\"}"), 0);
}

TEST_F(SessionMetrics, TheTimesOfFramesAreThoseOfTheirHeaders) {
  const auto client = join();
  work();
  acknowledge(*client);
  for (int i = 0; i < 5; ++i) {
    edit(*client, 10 * i);
    pass(milliseconds(1));
    acknowledge(*client);
  }
  double queue_ms = 0, render_ms = 0, encode_ms = 0;
  int moving = 0;
  for (const FramePtr& frame : client->frames) {
    const FrameHeader header = parse_frame_message(frame->bytes(), "frame").header;
    if (header.exact) continue;
    ++moving;
    queue_ms += header.queue_ms;
    render_ms += header.rotate_ms + header.update_ms + header.display_ms;
    encode_ms += header.encode_ms;
  }
  EXPECT_EQ(moving, 5);
  EXPECT_EQ(value("rimlight_queue_age_seconds_count{kind=\"moving\"}"), 5);
  EXPECT_NEAR(value("rimlight_queue_age_seconds_sum{kind=\"moving\"}"), queue_ms / 1000, 1e-9);
  EXPECT_NEAR(value("rimlight_render_seconds_sum{kind=\"moving\"}"), render_ms / 1000, 1e-9);
  EXPECT_NEAR(value("rimlight_encode_seconds_sum{kind=\"moving\"}"), encode_ms / 1000, 1e-9);
  EXPECT_GT(queue_ms, 4.9);
}

TEST_F(SessionMetrics, AFrameThatCannotBeMadeIsAnErrorAndASessionThatEndsIsNoneAnyMore) {
  const auto client = join();
  probe->broken = true;
  work();
  EXPECT_EQ(value("rimlight_frame_errors_total"), 1);
  EXPECT_EQ(value("rimlight_frames_total{codec=\"png\",kind=\"exact\"}"), 0);
  session->leave(*client, now);
  session.reset();
  EXPECT_EQ(value("rimlight_sessions"), 0);
}

TEST_F(SessionMetrics, EditsThatNobodyWatchesHaveNoLatency) {
  const auto first = join();
  work();
  acknowledge(*first);
  edit(*first, 10);
  session->leave(*first, now);
  now += seconds(100);
  const auto second = join();
  work();
  EXPECT_EQ(second->frames.size(), 1u);
  EXPECT_EQ(value("rimlight_edit_to_frame_seconds_count{kind=\"moving\"}"), 0);
  EXPECT_EQ(value("rimlight_edit_to_frame_seconds_count{kind=\"exact\"}"), 0);
}

TEST(StoreMetrics, CommitsAndWhatWaitsForThem) {
  const rimlight::test::TemporaryFolder folder;
  const auto metrics = std::make_shared<ServerMetrics>();
  SqliteStore store({.file = folder / "s.sqlite", .metrics = metrics});
  for (int i = 1; i <= 20; ++i) store.append(test::numbered_edit(i), [](const auto&) {});
  ASSERT_TRUE(store.drain(seconds(10)));
  const MetricsText text = read(*metrics);
  EXPECT_EQ(text.at("rimlight_store_waiting_edits"), 0);
  EXPECT_EQ(text.at("rimlight_store_waiting_bytes"), 0);
  const auto commits = static_cast<double>(store.commits());
  EXPECT_EQ(text.at("rimlight_store_commit_seconds_count"), commits);
  EXPECT_EQ(text.at("rimlight_store_wait_seconds_count"), commits);
  EXPECT_GE(text.at("rimlight_store_wait_seconds_sum"),
            text.at("rimlight_store_commit_seconds_sum"));
  EXPECT_EQ(text.at("rimlight_store_errors_total"), 0);
}

/// A server and what it counts.
class ServedMetrics : public testing::Test {
 protected:
  LoopbackServer::Settings settings() const {
    LoopbackServer::Settings settings;
    settings.network.metrics = metrics;
    settings.sessions.session.metrics = metrics;
    return settings;
  }
  MetricsText scrape(const LoopbackServer& server, const std::string& headers = "") const {
    const std::string response = test::http(server.port(), "GET", "/metrics", headers);
    EXPECT_EQ(test::status_line(response), "HTTP/1.1 200 OK");
    EXPECT_NE(response.find("Content-Type: text/plain; version=0.0.4; charset=utf-8\r\n"),
              std::string::npos);
    return parse_metrics(response.substr(response.find("\r\n\r\n") + 4));
  }
  /// Waits until the sample is that, since connections end a moment after their clients.
  void expect_soon(const std::string& sample, double value) const {
    const auto end = Clock::now() + seconds(10);
    while (read(*metrics).at(sample) != value && Clock::now() < end) {
      std::this_thread::sleep_for(milliseconds(2));
    }
    EXPECT_EQ(read(*metrics).at(sample), value) << sample;
  }

  const std::shared_ptr<ServerMetrics> metrics = std::make_shared<ServerMetrics>();
};

TEST_F(ServedMetrics, CountWhatAScriptOfClientsDoes) {
  LoopbackServer::Settings never_late = settings();
  never_late.overload = {.comfortable = hours(1), .refusing = hours(1), .shedding = hours(1)};
  const LoopbackServer server(never_late);
  const auto client = server.open("a");
  std::size_t frame_bytes = 0, text_bytes = 0, frames = 0, texts = 0, sent_bytes = 0, sent = 0;
  const auto send = [&](const std::string& text) {
    ASSERT_TRUE(client->send_text(text));
    sent_bytes += text.size();
    ++sent;
  };
  send(R"({"type":"edit","id":"1","rotation":[0,0,0,1]})");
  send("nonsense");
  bool is_exact = false;
  for (const auto end = Clock::now() + seconds(10);;) {
    const auto received = client->receive(is_exact ? Clock::now() + milliseconds(100) : end);
    if (std::holds_alternative<StreamClient::Nothing>(received)) break;
    if (const auto* const frame = std::get_if<StreamClient::Binary>(&received)) {
      const FrameHeader header = parse_frame_message(frame->bytes, "frame").header;
      frame_bytes += frame->bytes.size();
      ++frames;
      send(R"({"type":"frame_ack","frame":)" + std::to_string(header.frame) + "}");
      is_exact |= header.exact && header.revision.number == 1;
    } else if (const auto* const text = std::get_if<StreamClient::Text>(&received)) {
      text_bytes += text->text.size();
      ++texts;
    } else {
      FAIL() << "the connection ended";
    }
  }
  ASSERT_TRUE(is_exact);
  const MetricsText open = scrape(server);
  EXPECT_EQ(open.at("rimlight_overload_stage"), 0);
  EXPECT_EQ(open.at("rimlight_budget_share"), 1);
  EXPECT_EQ(open.at("rimlight_connections"), 1);
  EXPECT_EQ(open.at("rimlight_sockets"), 2);
  client->close();
  expect_soon("rimlight_connections_closed_total{outcome=\"client_closed\"}", 1);
  const MetricsText text = scrape(server);
  EXPECT_EQ(text.at("rimlight_connections"), 0);
  EXPECT_EQ(text.at("rimlight_edits_total"), 1);
  EXPECT_EQ(text.at("rimlight_refusals_total{reason=\"message\"}"), 1);
  EXPECT_EQ(text.at("rimlight_received_messages_total"), static_cast<double>(sent));
  EXPECT_EQ(text.at("rimlight_received_bytes_total"), static_cast<double>(sent_bytes));
  EXPECT_EQ(text.at("rimlight_sent_messages_total{content=\"frame\"}"),
            static_cast<double>(frames));
  EXPECT_EQ(text.at("rimlight_sent_bytes_total{content=\"frame\"}"),
            static_cast<double>(frame_bytes));
  EXPECT_EQ(text.at("rimlight_sent_messages_total{content=\"text\"}"), static_cast<double>(texts));
  EXPECT_EQ(text.at("rimlight_sent_bytes_total{content=\"text\"}"),
            static_cast<double>(text_bytes));
}

TEST_F(ServedMetrics, SayThatFramesAreLate) {
  LoopbackServer::Settings always_late = settings();
  always_late.overload.comfortable = milliseconds(0);
  const LoopbackServer server(always_late);
  const auto client = server.open("a");
  for (bool framed = false; !framed;) {
    const auto received = client->receive(Clock::now() + seconds(10));
    framed = !std::holds_alternative<StreamClient::Text>(received);
  }
  const MetricsText text = scrape(server);
  EXPECT_EQ(text.at("rimlight_overload_stage"), 1);
  EXPECT_EQ(text.at("rimlight_budget_share"), always_late.overload.least_share);
  EXPECT_GT(text.at("rimlight_lateness_seconds"), 0);
}

TEST_F(ServedMetrics, CountRefusalsByTheirReason) {
  LoopbackServer server(settings());
  (void)test::upgrade(server, "/sessions/a/stream", "Origin: http://evil.example\r\n");
  (void)test::upgrade(server, "/sessions/a/stream?scene=none");
  (void)test::upgrade(server, "/sessions/a b/stream");
  (void)test::http(server.port(), "GET", "/none");
  (void)test::http(server.port(), "DELETE", "/");
  (void)test::raw(server, "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n");
  (void)test::raw(server, "nonsense\r\n\r\n");
  (void)test::raw(server, "GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\n");
  const MetricsText text = read(*metrics);
  const auto refusals = [&](const std::string& reason) {
    return text.at("rimlight_refusals_total{reason=\"" + reason + "\"}");
  };
  EXPECT_EQ(refusals("origin"), 1);
  EXPECT_EQ(refusals("not_found"), 2);
  EXPECT_EQ(refusals("method"), 1);
  EXPECT_EQ(refusals("host"), 1);
  EXPECT_EQ(refusals("malformed"), 2);  // a space in the target too
  EXPECT_EQ(refusals("body"), 1);
}

TEST_F(ServedMetrics, AreForOwnersOfAllSessionsOnceThereAreKeys) {
  const auto keys =
      std::make_shared<const SigningKeys>(std::vector<SigningKey>{{"new", std::string(32, 'n')}});
  LoopbackServer::Settings locked = settings();
  locked.network.keys = keys;
  const LoopbackServer server(locked);
  const auto bearer = [&](Role role, const std::string& session) {
    const auto now = WallClock::now();
    return "Authorization: Bearer " +
           issue_token({role, session, "", now + std::chrono::hours(1)}, *keys, now) + "\r\n";
  };
  const auto status = [&](const std::string& headers) {
    return test::status_line(test::http(server.port(), "GET", "/metrics", headers)).substr(9, 3);
  };
  EXPECT_EQ(status(""), "401");
  EXPECT_EQ(status("Authorization: Bearer nonsense\r\n"), "401");
  EXPECT_EQ(status(bearer(Role::editor, "*")), "403");
  EXPECT_EQ(status(bearer(Role::owner, "a")), "403");
  EXPECT_EQ(
      scrape(server, bearer(Role::owner, "*")).at("rimlight_refusals_total{reason=\"token\"}"), 2);
}

}  // namespace
}  // namespace rimlight::server
