#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "server/protocol/query_string.h"
#include "tests/server/curve_sphere.h"
#include "tests/server/loopback_server.h"
#include "tests/support/error_of.h"

namespace rimlight::server {
namespace {

using nlohmann::json;
using rimlight::test::error_of;
using testing::HasSubstr;

TEST(QueryStrings, AreDecodedAndBadOnesAreRefused) {
  const auto parsed_query = [](std::string_view text) { return parse_query(text, {"a", "b"}); };
  using Map = std::map<std::string, std::string>;
  EXPECT_EQ(parsed_query(""), Map());
  EXPECT_EQ(parsed_query("a=x%20y+z&b=%C3%a9"), (Map{{"a", "x y z"}, {"b", "é"}}));
  EXPECT_EQ(parsed_query("b=1=2&a="), (Map{{"b", "1=2"}, {"a", ""}}));
  for (const char* const bad :
       {"a", "c=1", "a=1&a=2", "a=%", "a=%4", "a=%g1", "a=%+1", "&", "a=1&&"}) {
    EXPECT_THAT(error_of([&] { parsed_query(bad); }), HasSubstr("URL")) << bad;
  }
}

TEST(Curves, AreServedByNameAsTheyWereBakedOrMeasured) {
  const test::LoopbackServer server;
  const auto get = [&](const std::string& query) {
    const std::string response = test::http(server.port(), "GET", "/api/curves?" + query);
    EXPECT_TRUE(response.starts_with("HTTP/1.1 200")) << response.substr(0, 300);
    EXPECT_THAT(response, HasSubstr("Content-Type: application/json"));
    return json::parse(response.substr(response.find("\r\n\r\n")));
  };
  const ServedScene scene = test::curve_sphere_scene("curves", 8);
  const json pearl = get("scene=curves&material=pearl");
  const BrdfCurve lobe = *factor_curve(scene.editable[0].brdf, CurveAxis::half_angle);
  ASSERT_EQ(pearl["half_angle"].size(), 256u);
  ASSERT_EQ(pearl["difference_angle"].size(), 256u);
  for (std::size_t i = 0; i < kCurveBins; ++i) {
    EXPECT_EQ(pearl["half_angle"][i][1], lobe.values[i].y) << i;
  }
  EXPECT_TRUE(pearl["fit_error"].is_null());
  EXPECT_TRUE(get("scene=curves&material=red%20%26+blue")["difference_angle"].is_null());
  const json gold = get("scene=curves&material=brushed&measured=gold");
  EXPECT_EQ(gold["half_angle"][7][2], test::made_up_measured().half_angle.values[7].z);
  EXPECT_EQ(gold["rest"].size(), kRestKnots);
  EXPECT_EQ(gold["fit_error"]["relative"], json({0.05, 0.06, 0.07}));
}

TEST(Curves, OfUnknownNamesAreNotFoundWithAReason) {
  const test::LoopbackServer server;
  for (const auto& [query, reason] : std::vector<std::pair<std::string, std::string>>{
           {"?scene=none&material=pearl", "the scene"},
           {"?scene=curves&material=iron", "one of"},
           {"?scene=curves", "the editable material"},
           {"?scene=sphere&material=pearl", "a scene that has one"},
           {"?scene=curves&material=pearl&measured=iron", "the measured BRDF"},
           {"?scene=curves&material=%zz", "hexadecimal"},
           {"?scene=curves&material=%ff%fe", "the editable material"},
           {"?material=pearl&colour=red", "colour=red"},
           {"", "the editable material"}}) {
    const std::string response = test::http(server.port(), "GET", "/api/curves" + query);
    EXPECT_TRUE(response.starts_with("HTTP/1.1 404")) << query;
    const json body = json::parse(response.substr(response.find("\r\n\r\n")));
    EXPECT_EQ(body["type"], "error");
    EXPECT_THAT(body["reason"].get<std::string>(), HasSubstr(reason)) << query;
  }
}

/// The next text message; frames are not acknowledged.
json next_text(StreamClient& client) {
  for (;;) {
    const auto received = client.receive(Clock::now() + std::chrono::seconds(10));
    if (const auto* const text = std::get_if<StreamClient::Text>(&received)) {
      return json::parse(text->text);
    }
    if (!std::holds_alternative<StreamClient::Binary>(received)) return nullptr;
  }
}

TEST(CurveSessions, BadCurvesGetErrorsAndTheSessionStaysAsItWas) {
  const test::LoopbackServer server;
  StreamClient client({"127.0.0.1", std::to_string(server.port())},
                      "/sessions/bad/stream?scene=curves");
  EXPECT_EQ(next_text(client)["editable"].size(), 3u);
  const auto send = [&](const std::string& id, const std::string& material) {
    EXPECT_TRUE(client.send_text(R"({"type":"edit","exposure":3,"id":")" + id + R"(","material":)" +
                                 material + "}"));
    return next_text(client);
  };
  const json bins(257, json{1, 1, 1});
  const auto curve = [](const std::string& name, const std::string& text) {
    return R"({"curve":{")" + name + R"(":{"half_angle":)" + text + "}}}";
  };
  for (const std::string& bad : {curve("pearl", json{{"values", bins}}.dump()),
                                 curve("iron", "null"), std::string(R"({"load":{"pearl":"iron"}})"),
                                 curve("pearl", R"({"scale":"linear","points":[[0,1,1,1e400]]})"),
                                 std::string(R"({"parameter":{"pearl":{"eta":0}}})")}) {
    const json reply = send("bad", bad);
    EXPECT_EQ(reply["type"], "error") << bad;
    EXPECT_EQ(reply.value("id", "bad"), "bad") << "but for text that is no JSON: 1e400 is none";
  }
  const json good = send("good", R"({"load":{"brushed":"gold"}})");
  ASSERT_EQ(good["type"], "ack");
  EXPECT_EQ(good["revision"], 1);
  EXPECT_EQ(good["state"]["material"], json({{"parameter", json::object()},
                                             {"curve", json::object()},
                                             {"load", {{"brushed", "gold"}}}}));
}

}  // namespace
}  // namespace rimlight::server
