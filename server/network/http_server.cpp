#include "server/network/http_server.h"

#include <algorithm>
#include <atomic>
#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <csignal>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "server/access/address_limit.h"
#include "server/access/host_policy.h"
#include "server/log/event_log.h"
#include "server/network/http_session.h"
#include "server/network/stop_gate.h"
#include "server/network/tls_context.h"
#include "server/network/transport.h"
#include "server/network/upload_desk.h"
#include "server/network/waiting_room.h"

namespace rimlight::server {
namespace {

namespace beast = boost::beast;
namespace net = boost::asio;
using Tcp = net::ip::tcp;

constexpr auto kAsTuple = net::as_tuple(net::use_awaitable);
constexpr std::chrono::seconds kHousekeeping{10};
constexpr std::chrono::milliseconds kPause{20};
/// Sockets above the bound that are still told why they are refused.
constexpr std::size_t kRefusals = 32;
/// The same of one address.
constexpr std::size_t kRefusalsPerAddress = 4;
/// Of sockets that have not asked for anything: else a quarter of all.
constexpr std::size_t kFewestWaiting = 8;
/// Of one address when nothing else is set, beyond loopback.
constexpr std::size_t kPerAddress = 16;

Tcp::endpoint permitted_endpoint(const NetworkSettings& settings) {
  const std::string where = settings.host + ":" + std::to_string(settings.port);
  beast::error_code failure;
  const auto address =
      net::ip::make_address(settings.host == "localhost" ? "127.0.0.1" : settings.host, failure);
  if (failure) throw Error(where, "no address", "an IP address, or localhost");
  if (!address.is_loopback() && !settings.keys) {
    throw Error(where, "an address that other machines reach, and no signing keys",
                "a loopback address (127.0.0.1, ::1, localhost), or keys for access tokens: "
                "rimlight token --new-key FILE, then serve --key FILE");
  }
  if (!address.is_loopback() && settings.selftest_echo) {
    throw Error(where, "an address that other machines reach, and --selftest-echo",
                "a loopback address: the echo is for conformance suites alone");
  }
  return {address, settings.port};
}

Tcp::acceptor listening(net::io_context& context, const NetworkSettings& settings) {
  const Tcp::endpoint endpoint = permitted_endpoint(settings);
  Tcp::acceptor acceptor(net::make_strand(context));
  beast::error_code failure;
  acceptor.open(endpoint.protocol(), failure);
  if (!failure) acceptor.set_option(net::socket_base::reuse_address(true), failure);
  if (!failure) acceptor.bind(endpoint, failure);
  if (!failure) acceptor.listen(net::socket_base::max_listen_connections, failure);
  if (failure) {
    throw Error(settings.host + ":" + std::to_string(settings.port), failure.message(),
                "an address that is free to listen on");
  }
  return acceptor;
}

void log_failure(const std::exception_ptr& failure) {
  if (!failure) return;
  try {
    std::rethrow_exception(failure);
  } catch (const std::exception& error) {
    log_event(Severity::warning, "connection_failed", {{"detail", error.what()}});
  }
}

std::size_t most_per_address(const Tcp::acceptor& acceptor, const NetworkSettings& settings) {
  const bool is_loopback = acceptor.local_endpoint().address().is_loopback();
  return settings.most_connections_per_address.value_or(is_loopback ? SIZE_MAX / 2 : kPerAddress);
}

HostPolicy host_policy(const Tcp::acceptor& acceptor, const NetworkSettings& settings) {
  const bool is_loopback = acceptor.local_endpoint().address().is_loopback();
  return {is_loopback ? HostPolicy::Reach::loopback : HostPolicy::Reach::network,
          settings.host_names, settings.origins};
}

/// With the port that it really has.
std::string address_of(const Tcp::acceptor& acceptor, const NetworkSettings& settings) {
  const Tcp::endpoint endpoint = acceptor.local_endpoint();
  const std::string host = endpoint.address().to_string();
  return (settings.tls.empty() ? "http://" : "https://") +
         (endpoint.address().is_v6() ? "[" + host + "]" : host) + ":" +
         std::to_string(endpoint.port());
}

}  // namespace

struct HttpServer::State {
  State(const NetworkSettings& settings_, const StaticFiles& files, SessionRegistry& sessions_)
      : settings(settings_),
        sessions(sessions_),
        waiting(std::max(kFewestWaiting, settings_.most_connections / 4)),
        uploads(settings_.decoder),
        context(settings_.threads),
        acceptor(listening(context, settings)),
        tls(settings.tls.empty() ? nullptr : server_tls(settings.tls)),
        address(address_of(acceptor, settings)),
        hosts(host_policy(acceptor, settings)),
        most_of_address(most_per_address(acceptor, settings)),
        signals(acceptor.get_executor()),
        reload(acceptor.get_executor()),
        timer(acceptor.get_executor()),
        site{settings, hosts, files, sessions_, gate, stopping, disk, opening, uploads, waiting} {}

  ~State() { uploads.close(); }  // its thread answers on the context

  const NetworkSettings settings;
  SessionRegistry& sessions;
  AddressLimit addresses;
  std::atomic<std::size_t> opening{0};
  // These outlive the coroutines that the context destroys after a hard stop.
  StopGate gate;
  WaitingRoom waiting;
  UploadDesk uploads;
  net::io_context context;
  // The acceptor and what follows, but the address, are its strand's.
  Tcp::acceptor acceptor;
  std::shared_ptr<net::ssl::context> tls;  // null: in the clear; what runs keeps its own
  const std::string address;
  const HostPolicy hosts;
  const std::size_t most_of_address;
  net::signal_set signals;
  net::signal_set reload;             // of the files of TLS
  net::steady_timer timer;            // of the housekeeping
  std::atomic<bool> stopping{false};  // no new sessions
  bool closing = false;               // no sockets any more
  std::int64_t sockets = 0;           // so far: their ids in the log
  net::thread_pool disk{1};           // ends before the context, to which its results go
  Site site;

  net::awaitable<void> accept();
  void take(Tcp::socket socket);
  void refuse_unheard(std::int64_t socket) const;
  net::awaitable<void> keep_house();
  net::awaitable<void> finish(std::chrono::milliseconds notice);
  net::awaitable<void> close_hard();
  void begin_drain(std::chrono::milliseconds notice);
  void watch_signals();
  void watch_reload();
  void stop();
};

net::awaitable<void> HttpServer::State::accept() {
  while (acceptor.is_open()) {
    auto [error, socket] = co_await acceptor.async_accept(net::make_strand(context), kAsTuple);
    if (error == net::error::operation_aborted) co_return;
    if (error) {
      // Out of file descriptors, most likely: others must close first.
      log_event(Severity::warning, "accept_failed", {{"detail", error.message()}});
      net::steady_timer pause(acceptor.get_executor(), kPause);
      co_await pause.async_wait(kAsTuple);
      continue;
    }
    take(std::move(socket));
  }
}

/// Serves the socket, or refuses it, or closes it unheard when it is one too many for that.
void HttpServer::State::take(Tcp::socket socket) {
  beast::error_code failure;
  const Tcp::endpoint peer = socket.remote_endpoint(failure);
  if (failure) return;  // gone already
  socket.set_option(Tcp::no_delay(true), failure);
  const auto executor = socket.get_executor();
  const std::string from = counted_address(peer.address().to_string());
  beast::tcp_stream stream(std::move(socket));
  auto session = std::make_shared<HttpSession>(
      tls ? Transport(std::move(stream), *tls) : Transport(std::move(stream)), site, ++sockets);
  const std::size_t of_address = addresses.enter(from);
  if (of_address > most_of_address + kRefusalsPerAddress ||
      !gate.enter(session, settings.most_connections + kRefusals)) {
    addresses.leave(from);
    refuse_unheard(sockets);
    return;
  }
  if (of_address > most_of_address || gate.size() > settings.most_connections) {
    session->refuse_all();
  }
  net::co_spawn(executor, session->run(), [this, session, from](const std::exception_ptr& thrown) {
    addresses.leave(from);
    gate.leave(*session);
    log_failure(thrown);
  });
}

void HttpServer::State::refuse_unheard(std::int64_t socket) const {
  constexpr RefusalReason kReason = RefusalReason::too_many_sockets;
  settings.metrics->refused(kReason);
  log_event(Severity::warning, "refused", {{"connection", socket}, {"reason", to_string(kReason)}});
}

net::awaitable<void> HttpServer::State::keep_house() {
  while (!closing) {
    sessions.drop_idle(Clock::now());
    timer.expires_after(kHousekeeping);
    co_await timer.async_wait(kAsTuple);
  }
}

void HttpServer::State::watch_signals() {
  signals.add(SIGINT);
  signals.add(SIGTERM);
  if (tls) {
    reload.add(SIGHUP);
    watch_reload();
  }
  signals.async_wait([this](beast::error_code error, int signal) {
    if (error) return;
    // Before the drain begins: it may end at once, and then cancels this.
    signals.async_wait([this](beast::error_code second, int) {
      if (!second) context.stop();
    });
    // A proxy needs time to see that the server is leaving; a person at a terminal does not.
    begin_drain(signal == SIGTERM ? settings.drain_notice : std::chrono::milliseconds(0));
  });
}

void HttpServer::State::begin_drain(std::chrono::milliseconds notice) {
  if (stopping.exchange(true)) return;
  settings.metrics->stopping();
  sessions.finish();
  log_event(Severity::info, "stopping", {{"sockets", static_cast<std::int64_t>(gate.size())}});
  net::co_spawn(acceptor.get_executor(), finish(notice), log_failure);
}

net::awaitable<void> HttpServer::State::finish(std::chrono::milliseconds notice) {
  const Clock::time_point start = Clock::now();
  const auto goes_on = [&] {
    const auto passed = Clock::now() - start;
    return passed < notice || (passed < settings.finish_deadline && !sessions.finished());
  };
  while (goes_on() && !closing) {
    net::steady_timer pause(acceptor.get_executor(), kPause);
    co_await pause.async_wait(kAsTuple);
  }
  stop();
}

/// What is wrong with new files is said, and changes nothing.
void HttpServer::State::watch_reload() {
  reload.async_wait([this](beast::error_code error, int) {
    if (error) return;
    try {
      tls = server_tls(settings.tls);
      log_event(Severity::info, "certificate_read", {{"file", settings.tls.certificate.string()}});
    } catch (const std::exception& fault) {
      log_event(Severity::error, "certificate_kept", {{"detail", fault.what()}});
    }
    watch_reload();
  });
}

/// On the acceptor's strand. First politely, then, at the deadline, hard.
void HttpServer::State::stop() {
  if (std::exchange(closing, true)) return;
  stopping = true;
  beast::error_code ignored;
  acceptor.close(ignored);
  reload.cancel(ignored);
  timer.cancel();
  uploads.stop();
  gate.close();
  net::co_spawn(acceptor.get_executor(), close_hard(), log_failure);
}

/// The context runs dry by itself when the last socket is closed, and no signal is waited for.
net::awaitable<void> HttpServer::State::close_hard() {
  const Clock::time_point end = Clock::now() + settings.stop_deadline;
  while (gate.size() > 0 && Clock::now() < end) {
    net::steady_timer pause(acceptor.get_executor(), kPause);
    co_await pause.async_wait(kAsTuple);
  }
  if (gate.size() > 0) {
    log_event(Severity::warning, "closed_hard",
              {{"sockets", static_cast<std::int64_t>(gate.size())}});
    context.stop();
  }
  beast::error_code ignored;
  signals.cancel(ignored);
}

void check_network(const NetworkSettings& settings) {
  (void)permitted_endpoint(settings);
  (void)HostPolicy(HostPolicy::Reach::network, settings.host_names, settings.origins);
  if (!settings.tls.empty()) (void)server_tls(settings.tls);
}

HttpServer::HttpServer(const NetworkSettings& settings, const StaticFiles& files,
                       SessionRegistry& sessions)
    : state_(std::make_unique<State>(settings, files, sessions)) {}

HttpServer::~HttpServer() = default;

std::string HttpServer::address() const { return state_->address; }

void HttpServer::run(Signals signals) {
  State& state = *state_;
  if (signals == Signals::watch) state.watch_signals();
  net::co_spawn(state.acceptor.get_executor(), state.accept(), log_failure);
  net::co_spawn(state.acceptor.get_executor(), state.keep_house(), log_failure);
  std::vector<std::jthread> threads;
  for (int i = 1; i < state.settings.threads; ++i) {
    threads.emplace_back([&state] { state.context.run(); });
  }
  state.context.run();
}

void HttpServer::drain() {
  net::post(state_->acceptor.get_executor(),
            [state = state_.get()] { state->begin_drain(state->settings.drain_notice); });
}

void HttpServer::stop() {
  net::post(state_->acceptor.get_executor(), [state = state_.get()] { state->stop(); });
}

}  // namespace rimlight::server
