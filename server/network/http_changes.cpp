// Changes of sessions by HTTP: an uploaded environment is deleted, a whole state is imported.

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/string.hpp>
#include <chrono>
#include <future>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/error.h"
#include "server/network/disk_thread.h"
#include "server/network/http_session.h"
#include "server/network/request_checks.h"
#include "server/network/responses.h"
#include "server/network/upload_desk.h"

namespace rimlight::server {
namespace {

namespace http = boost::beast::http;
namespace net = boost::asio;

using Request = HttpSession::Request;
using Response = HttpSession::Response;

/// For the disk, until an import is refused.
constexpr std::chrono::seconds kPatience{10};

std::string_view view(boost::beast::string_view text) { return {text.data(), text.size()}; }

Refusal of(http::status status, RefusalReason why, const Error& error) {
  return {status, {}, why, error.what()};
}

/// Those that send changes by HTTP are not in the session otherwise: it shows them nothing, and
/// waits for the one answer.
class Sender final : public Client {
 public:
  void send_text(std::string) override {}
  void send_state(std::string) override {}
  void send_presence(std::string) override {}
  void send_snapshots(std::string) override {}
  void send_frame(FramePtr) override {}
  void send_answer(std::string text) override { answer_.set_value(std::move(text)); }

  /// The ack, or an error, to the one command that was sent.
  std::string wait() {
    auto answer = answer_.get_future();
    if (answer.wait_for(kPatience) != std::future_status::ready) {
      throw StoreError("server", "a store that does not answer", "try again later");
    }
    return answer.get();
  }

 private:
  std::promise<std::string> answer_;
};

/// Joined for as long as it is there.
class Joined {
 public:
  Joined(std::shared_ptr<DesignSession> session, const Client& client)
      : session_(std::move(session)), client_(client) {}
  Joined(const Joined&) = delete;
  Joined& operator=(const Joined&) = delete;
  ~Joined() {
    if (session_) session_->leave(client_, Clock::now());
  }

 private:
  const std::shared_ptr<DesignSession> session_;
  const Client& client_;
};

/// The ack to an import of what a file says. Throws Error as it is refused.
std::string import_into(DesignSession& session, Sender& sender, const std::string& bytes) {
  session.set_display(sender, {.hidden = true}, Clock::now());
  const Import import = read_export(bytes, session.environments().names(), session.materials());
  session.apply(sender, import, Clock::now());
  const std::string answer = sender.wait();
  const nlohmann::json message = nlohmann::json::parse(answer);
  if (message.at("type") == "error") {
    throw StoreError("session", message.at("reason").get<std::string>(), "try again later");
  }
  return answer;
}

}  // namespace

/// Who may change it: of the header's token, never the query's.
std::variant<Access, Refusal> HttpSession::admit_change(const Request& request,
                                                        const std::string& session,
                                                        Role least) const {
  if (auto fault = origin_fault(request, site_.hosts)) return *fault;
  if (site_.stopping) {
    return Refusal{http::status::service_unavailable, "the server is stopping; try again later",
                   RefusalReason::stopping};
  }
  auto admitted = admit(request, {}, session, site_.settings.keys.get());
  const Access* const access = std::get_if<Access>(&admitted);
  if (access != nullptr && access->role < least) {
    return Refusal{http::status::forbidden, "this access token does not let you do that",
                   RefusalReason::forbidden, "of a lesser role"};
  }
  return admitted;
}

net::awaitable<Response> HttpSession::respond_to_removal(const Request& request) {
  std::optional<Response> refusal;
  try {
    const UploadTarget target = parse_upload_target(view(request.target()));
    const auto admitted = admit_change(request, target.session, Role::editor);
    if (const auto* const fault = std::get_if<Refusal>(&admitted)) {
      co_return refuse(request, *fault);
    }
    const auto remove = [&sessions = site_.sessions, target] {
      const auto session = sessions.open(target.session, target.scene);
      if (!session) return http::status::service_unavailable;
      if (!session->environments().find_uploaded(target.environment))
        return http::status::not_found;
      sessions.remove_environment(*session, target.environment);
      return http::status::ok;
    };
    const http::status status = co_await on_disk_thread(site_, remove);
    if (status == http::status::ok) {
      const nlohmann::json answer{{"environment", target.environment}};
      co_return json_body(request, status, answer.dump());
    }
    const bool is_full = status == http::status::service_unavailable;
    const Refusal fault{status,
                        is_full ? "the server has no place for another session; try again later"
                                : "there is no such uploaded environment",
                        is_full ? RefusalReason::too_many_sessions : RefusalReason::not_found};
    refusal = refuse(request, fault);
  } catch (const StoreError& error) {
    const Refusal fault = of(http::status::service_unavailable, RefusalReason::store, error);
    refusal = refuse(request, fault, error);
  } catch (const Error& error) {
    const Refusal fault = of(http::status::conflict, RefusalReason::upload, error);
    refusal = refuse(request, fault, error);
  }
  co_return std::move(*refusal);
}

/// Of the header alone.
std::variant<HttpSession::StateImport, HttpSession::Response> HttpSession::check_state(
    const Request& request, const boost::optional<std::uint64_t>& length) const {
  StateImport import;
  try {
    import.target = parse_state_target(view(request.target()));
  } catch (const Error& error) {
    return refuse(request, of(http::status::not_found, RefusalReason::not_found, error), error);
  }
  const auto admitted = admit_change(request, import.target.session, Role::owner);
  if (const auto* const fault = std::get_if<Refusal>(&admitted)) return refuse(request, *fault);
  import.access = std::get<Access>(admitted);
  if (!length) {
    return refuse(request, {http::status::length_required, "Content-Length is needed",
                            RefusalReason::upload});
  }
  if (*length > kLargestState) {
    return refuse(request, {http::status::payload_too_large, "at most 4 MiB are taken",
                            RefusalReason::upload});
  }
  import.place = site_.uploads.take_place();
  if (!import.place) {
    return refuse(request, {http::status::service_unavailable,
                            "too many uploads at once; try again later", RefusalReason::upload});
  }
  return {std::move(import)};
}

net::awaitable<void> HttpSession::take_state(HeaderParser& header,
                                             boost::beast::flat_buffer& buffer) {
  Request request(header.get().base());
  request.keep_alive(false);
  auto checked = check_state(request, header.content_length());
  if (auto* const refusal = std::get_if<Response>(&checked)) {
    co_await refuse_upload(std::move(*refusal));
    co_return;
  }
  std::string bytes;
  const bool arrived = co_await read_upload(header, buffer, bytes);
  if (!arrived) co_return;
  const StateImport import = std::get<StateImport>(std::move(checked));
  const auto work = [&]() -> net::awaitable<Response> {
    co_return import_state(request, import, bytes);
  };
  net::awaitable<Response> result =
      net::co_spawn(site_.uploads.pool().get_executor(), work, net::use_awaitable);
  Response response = co_await std::move(result);
  co_await answer(stream_, std::move(response));
}

/// On the desk's thread.
HttpSession::Response HttpSession::import_state(const Request& request, const StateImport& import,
                                                const std::string& bytes) const {
  const auto sender = std::make_shared<Sender>();
  const StreamTarget& target = import.target;
  const Visitor visitor{import.access.name, import.access.role, target.resume, target.seen};
  try {
    const auto session =
        site_.sessions.join(target.session, target.scene, sender, Clock::now(), visitor);
    const Joined joined(session, *sender);
    if (!session || session->finishing()) {
      return refuse(request, {http::status::service_unavailable,
                              "the server has no place for another session; try again later",
                              RefusalReason::too_many_sessions});
    }
    try {
      return json_body(request, http::status::ok, import_into(*session, *sender, bytes));
    } catch (const StoreError&) {
      throw;
    } catch (const Error& error) {
      return refuse(request, of(http::status::unprocessable_entity, RefusalReason::upload, error),
                    error);
    }
  } catch (const StoreError& error) {
    return refuse(request, of(http::status::service_unavailable, RefusalReason::store, error),
                  error);
  } catch (const Error& error) {
    return refuse(request, of(http::status::not_found, RefusalReason::not_found, error), error);
  }
}

/// For the connection's delete_by().
void HttpSession::delete_session(const std::shared_ptr<DesignSession>& session, const Author& by,
                                 const std::string& id) const {
  net::post(site_.disk, [&sessions = site_.sessions, session, by, id,
                         client = std::weak_ptr<Client>(connection_)] {
    try {
      sessions.remove(*session, by);
    } catch (const Error& error) {
      const auto name = id.empty() ? std::nullopt : std::optional(id);
      if (const auto owner = client.lock()) owner->send_text(write_error(error, name));
    }
  });
}

}  // namespace rimlight::server
