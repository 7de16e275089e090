// HTTP/1.1 (RFC 9110 and 9112) over a raw socket, as h1spec checks it: requests cut anywhere, and
// 22 that are wrong. With --selftest-echo a request's body is read and sent back, so that suites
// can send some; sessions' requests have none, and uploads a rule of their own.
#include <gtest/gtest.h>

#include <thread>

#include "tests/server/door_client.h"
#include "tests/server/loopback_server.h"

namespace rimlight::server {
namespace {

using test::LoopbackServer;
using test::RawSocket;
using test::status_line;

constexpr const char* kHost = "Host: example.com\r\n";

class HttpConformance : public testing::Test {
 protected:
  static LoopbackServer::Settings settings() {
    LoopbackServer::Settings result;
    result.network.selftest_echo = true;
    result.network.host_names = {"example.com"};
    return result;
  }
  /// The number in the first line of the answer, whether the server closes or not; 0 for none.
  int status_of(const std::vector<std::string>& parts) const {
    RawSocket socket(server.port());
    for (const std::string& part : parts) {
      socket.send(part);
      if (parts.size() > 1) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    const std::string answer = socket.read_some();
    return answer.size() > 12 ? std::stoi(answer.substr(9, 3)) : 0;
  }
  int status(const std::string& bytes) const { return status_of({bytes}); }

  LoopbackServer server{settings()};
};

TEST_F(HttpConformance, ARequestMayArriveCutAnywhere) {
  const std::string request =
      "GET /?some=query HTTP/1.1\r\nHost: example.com\r\nX-Field: a value\r\n\r\n";
  for (std::size_t cut = 1; cut < request.size(); ++cut) {
    EXPECT_EQ(status_of({request.substr(0, cut), request.substr(cut)}), 200) << cut;
  }
}

TEST_F(HttpConformance, GoodRequestsAreAnswered) {
  const std::string get = std::string("GET / HTTP/1.1\r\n") + kHost;
  EXPECT_EQ(status(get + "\r\n"), 200);
  EXPECT_EQ(status(get + "X-Empty: \r\n\r\n"), 200);
  EXPECT_EQ(status(get + "X-Empty:\r\n\r\n"), 200);
  EXPECT_EQ(status(get + "X-Spaces:   \t around \t \r\n\r\n"), 200);
  EXPECT_EQ(status(get + "X-All: !#$%&'*+-.^_`|~ \"(),/:;<=>?@[\\]{}\xc3\xa4\r\n\r\n"), 200);
  EXPECT_EQ(status(get + "!#$%&'*+-.^_`|~: name\r\n\r\n"), 200);
  EXPECT_EQ(status("GET / HTTP/1.1\r\nhOST: example.com\r\n\r\n"), 200);
  EXPECT_EQ(status("GET / HTTP/1.1\r\nHost:example.com:8080\r\n\r\n"), 200);
  EXPECT_EQ(status(get + "Content-Length: 0\r\n\r\n"), 200);
  const int expected = status(get + "Expect: 100-continue\r\n\r\n");
  EXPECT_TRUE(expected == 100 || expected == 200) << expected;
}

TEST_F(HttpConformance, BodiesAreReadAndSentBack) {
  const std::string post = std::string("POST / HTTP/1.1\r\nConnection: close\r\n") + kHost;
  for (const std::string& rest :
       {std::string("Content-Length: 5\r\n\r\nhello"),
        std::string("Transfer-Encoding: chunked\r\n\r\n2\r\nhe\r\n3;x=y\r\nllo\r\n0\r\n\r\n"),
        std::string("tRANSFER-eNCODING: Chunked\r\n\r\n5\r\nhello\r\n0\r\nTrailer: x\r\n\r\n")}) {
    const std::string answer = test::raw(server, post + rest);
    EXPECT_EQ(status_line(answer), "HTTP/1.1 200 OK") << rest;
    EXPECT_TRUE(answer.ends_with("\r\n\r\nhello")) << answer;
  }
}

TEST_F(HttpConformance, WrongRequestsAreRefusedAndTheConnectionClosed) {
  const std::string get = std::string("GET / HTTP/1.1\r\n") + kHost;
  const std::string post = std::string("POST / HTTP/1.1\r\n") + kHost;
  for (const std::string& wrong : std::initializer_list<std::string>{
           "GET / HTTP/1.1\r\n\r\n",                                       // no Host
           "GET / HTTP/1.1\r\nX: 1\r\n\r\n",                               //
           "POST / HTTP/1.1\r\nContent-Length: 5\r\n\r\n",                 // nor here, body pending
           get + kHost + "\r\n",                                           // two
           get + "Host: localhost\r\n\r\n",                                //
           "GET /\r\n" + std::string(kHost) + "\r\n",                      // no version
           "GET / \r\n" + std::string(kHost) + "\r\n",                     //
           "GET / HTTP/9.9\r\n" + std::string(kHost) + "\r\n",             // another version
           "GET / HTTP/1.1x\r\n" + std::string(kHost) + "\r\n",            //
           "GET / http/1.1\r\n" + std::string(kHost) + "\r\n",             //
           "GET / extra HTTP/1.1\r\n" + std::string(kHost) + "\r\n",       //
           "Extra line\r\n" + get + "\r\n",                                // before the request
           " GET / HTTP/1.1\r\n" + std::string(kHost) + "\r\n",            //
           get + "X[]: brackets in a name\r\n\r\n",                        //
           get + "X-Bell: a\x07z\r\n\r\n",                                 // control characters
           get + std::string("X-Null: a\0z\r\n\r\n", 15),                  //
           get + "X-Space : before the colon\r\n\r\n",                     // RFC 9112, 5.1
           get + ": no name\r\n\r\n",                                      //
           get + "no colon\r\n\r\n",                                       //
           "GET / HTTP/1.1\r\n Host: example.com\r\n\r\n",                 // space before the first
           get + "X: 1\r\r\n\r\n",                                         // line ending
           post + "Content-Length: -5\r\n\r\nhello",                       //
           post + "Content-Length: -123456789123456789123456789\r\n\r\n",  //
           post + "Content-Length: 123456789123456789123456789\r\n\r\n",   //
           post + "Content-Length: five\r\n\r\nhello",                     //
           post + "Content-Length: 5, 6\r\n\r\nhello",                     //
           post + "Content-Length: 5\r\nContent-Length: 6\r\n\r\nhello",   //
           post + "Content-Length: +5\r\n\r\nhello",                       //
           post + "Content-Length: 0x5\r\n\r\nhello",                      //
           // Smuggling: who reads which length?
           post + "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",  //
           post + "Transfer-Encoding: chunked\r\nContent-Length: 5\r\n\r\n0\r\n\r\n",  //
           post + "tRANSFER-encoding: chunked\r\ncONTENT-length: 5\r\n\r\n0\r\n\r\n",  //
           post + "Transfer-Encoding: chunked, identity\r\n\r\n0\r\n\r\n",             //
           post + "Transfer-Encoding: xchunked\r\n\r\n0\r\n\r\n",                      //
           post + "Transfer-Encoding: chunked\r\n\r\nzz\r\nhello\r\n0\r\n\r\n"}) {
    RawSocket socket(server.port());
    const auto start = Clock::now();
    socket.send(wrong);
    const std::string answer = socket.read_all();
    EXPECT_EQ(answer.substr(0, 10), "HTTP/1.1 4") << wrong << "\n---\n" << answer;
    EXPECT_LT(Clock::now() - start, std::chrono::seconds(2)) << wrong;
    EXPECT_EQ(answer.find("HTTP/1.1", 9), std::string::npos) << "two answers to " << wrong;
  }
}

}  // namespace
}  // namespace rimlight::server
