#include "http/server.h"

#include <fcntl.h>
#include <httplib.h>
#include <netinet/tcp.h>

#include <atomic>
#include <cerrno>
#include <cstring>

#include "base/ids.h"
#include "http/connection.h"
#include "http/connection_threads.h"
#include "http/dispatcher.h"
#include "http/reply_writer.h"
#include "http/request_head.h"

namespace drupe {

namespace {

constexpr int kBacklog = 256;  ///< the library compiles 5 in
constexpr std::chrono::milliseconds kReservedHeadTimeout{2'000};

/// What the library sees of a connection: the head that the fence made, then nothing; and the way back.
class ReplyStream : public httplib::Stream {
 public:
  ReplyStream(Connection& connection, std::string head) : connection_(connection), head_(std::move(head)) {}

  bool is_readable() const override { return position_ < head_.size(); }
  bool is_writable() const override { return !failed_; }
  ssize_t read(char* to, std::size_t size) override {
    const std::size_t count = std::min(size, head_.size() - position_);
    std::memcpy(to, head_.data() + position_, count);
    position_ += count;
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* bytes, std::size_t size) override {
    failed_ = failed_ || !connection_.Write({bytes, size});
    return failed_ ? -1 : static_cast<ssize_t>(size);
  }
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return 0; }  // never used: the library would select() on it
  bool failed() const { return failed_; }

 private:
  Connection& connection_;
  const std::string head_;
  std::size_t position_ = 0;
  bool failed_ = false;
};

/// A request between its head and the end of its reply.
struct Exchange {
  Connection* connection = nullptr;
  Result<RequestHead> head;
  bool reserved_only = false;  ///< the connection stands on a reserved place
  bool keep_alive = true;
};

/// The exchange that this thread is answering: the library's handlers have no other way to know.
thread_local Exchange* current = nullptr;

}  // namespace

class Server::Impl : public httplib::Server {
 public:
  Impl(const ServerOptions& options, Metrics* metrics) : options_(options), dispatcher_(options_, metrics) {
    new_task_queue = [this] { return NewConnectionThreads(options_.max_connections + options_.reserved_connections); };
    set_keep_alive_max_count(static_cast<std::size_t>(options_.max_requests_per_connection));
    set_keep_alive_timeout(std::chrono::duration_cast<std::chrono::seconds>(options_.keep_alive_timeout).count());
    // Only SO_REUSEADDR: with the library's SO_REUSEPORT a second server would silently share the port.
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    });
    set_pre_routing_handler([this](const httplib::Request&, httplib::Response& reply) {
      Answer(*current, reply);
      return HandlerResponse::Handled;
    });
    set_post_routing_handler([](const httplib::Request&, httplib::Response& reply) { FixHeaders(*current, reply); });
  }

  Status Listen();
  Status Accept();
  void StopAccepting();

  Router& router() { return dispatcher_.router(); }

  std::atomic<int> port{0};
  std::atomic<bool> stopping{false};

 private:
  bool process_and_close_socket(socket_t socket) override;
  void ServeConnection(Connection& connection, bool reserved_only);
  bool ServeRequest(Connection& connection, bool reserved_only, bool may_continue);
  void Refuse(Connection& connection);
  bool Exchanged(Exchange& exchange);
  void Answer(Exchange& exchange, httplib::Response& reply);
  static void FixHeaders(const Exchange& exchange, httplib::Response& reply);
  bool IsCrowded() const { return connections_ > options_.max_connections / 2; }

  const ServerOptions options_;
  Dispatcher dispatcher_;
  std::atomic<std::int64_t> body_deadline_ms_{kNoDeadline};
  std::atomic<int> connections_{0};
};

Status Server::Impl::Listen() {
  errno = 0;
  if (options_.port == 0) {
    port = bind_to_any_port(options_.host);
  } else {
    port = bind_to_port(options_.host, options_.port) ? options_.port : -1;
  }
  const std::string address = options_.host + ":" + std::to_string(options_.port);
  if (port <= 0) {
    if (errno == EADDRINUSE) {
      return Status(StatusKind::kConflict, "port_in_use", address + " is taken; is this service running already?");
    }
    return Internal("bind_failed", "cannot listen on " + address + ": " + std::strerror(errno));
  }
  ::listen(svr_sock_, kBacklog);
  return Status::Ok();
}

Status Server::Impl::Accept() {
  // The library's loop ends with false when its socket is shut down, which is how StopAccepting ends it.
  listen_after_bind();
  if (stopping) return Status::Ok();
  return Internal("listen_failed", std::string("accepting connections failed: ") + std::strerror(errno));
}

/// The library's own stop() would cut replies that are being sent, so only the listening socket is shut down; the
/// accept loop then ends and waits for the connections.
void Server::Impl::StopAccepting() {
  if (stopping.exchange(true)) return;
  body_deadline_ms_ = SteadyNowMs() + options_.stop_timeout.count();
  ::shutdown(svr_sock_, SHUT_RDWR);
}

bool Server::Impl::process_and_close_socket(socket_t socket) {
  ::fcntl(socket, F_SETFD, FD_CLOEXEC);
  const int yes = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
  Connection connection(socket, options_, body_deadline_ms_);
  if (IsRefusingConnection()) {
    Refuse(connection);
    return true;
  }
  const bool reserved_only = connections_.fetch_add(1) >= options_.max_connections;
  ServeConnection(connection, reserved_only);
  connections_.fetch_sub(1);
  return true;
}

void Server::Impl::ServeConnection(Connection& connection, bool reserved_only) {
  std::chrono::milliseconds idle = reserved_only ? kReservedHeadTimeout : options_.head_timeout;
  const int requests = reserved_only ? 1 : options_.max_requests_per_connection;
  for (int i = 0; i < requests; ++i) {
    const auto give_up = [&] { return stopping || (i > 0 && IsCrowded()); };
    if (!connection.WaitForRequest(idle, give_up)) return;
    if (!ServeRequest(connection, reserved_only, i + 1 < requests)) break;
    idle = options_.keep_alive_timeout;
  }
  connection.LingeringClose();
}

/// Reads and answers one request. False: the connection is to be closed.
bool Server::Impl::ServeRequest(Connection& connection, bool reserved_only, bool may_continue) {
  const Result<std::string> text = connection.ReadHead();
  if (!text.ok() && text.status().code() == "body_incomplete") return false;
  const HeadLimits limits{options_.max_target_bytes, options_.max_headers};
  Exchange exchange{&connection, text.ok() ? ParseRequestHead(*text, limits) : Result<RequestHead>(text.status())};
  exchange.reserved_only = reserved_only;
  exchange.keep_alive = exchange.head.ok() && exchange.head->keep_alive && may_continue;
  return Exchanged(exchange);
}

/// Tells a connection beyond every limit to come back later, without waiting for what it has to say.
void Server::Impl::Refuse(Connection& connection) {
  Exchange exchange{&connection, ServerBusy("every connection is taken")};
  exchange.keep_alive = false;
  Exchanged(exchange);
  connection.DiscardArrived();
}

/// Has the library write the reply to one exchange. It is shown a bare request line instead of the client's head.
bool Server::Impl::Exchanged(Exchange& exchange) {
  const bool is_head = exchange.head.ok() && exchange.head->method == "HEAD";
  if (exchange.head.ok()) {
    exchange.connection->StartBody(exchange.head->content_length, exchange.head->expects_continue);
  }
  ReplyStream stream(*exchange.connection, std::string(is_head ? "HEAD" : "GET") + " / HTTP/1.1\r\n\r\n");
  bool closed = false;
  current = &exchange;
  const bool written = process_request(stream, false, closed, nullptr);
  current = nullptr;
  return written && !stream.failed() && exchange.keep_alive;
}

void Server::Impl::Answer(Exchange& exchange, httplib::Response& reply) {
  Request request;
  request.id = NewId("req");
  request.body = exchange.connection;
  request.remote_address = exchange.connection->RemoteAddress();
  Response response = dispatcher_.Answer(std::move(exchange.head), exchange.reserved_only, request);
  if (exchange.connection->remaining() > 0 || IsCrowded() || stopping) exchange.keep_alive = false;
  FillReply(std::move(response), *exchange.connection, stopping, reply);
}

/// The library decides on Connection before the handler has run; here the last word is known.
void Server::Impl::FixHeaders(const Exchange& exchange, httplib::Response& reply) {
  if (!exchange.keep_alive) {
    reply.headers.erase("Keep-Alive");
    reply.headers.erase("Connection");
    reply.set_header("Connection", "close");
  }
  if (reply.status == 304 || reply.status == 204) reply.headers.erase("Content-Length");
}

Server::Server(ServerOptions options, Metrics* metrics) : impl_(std::make_unique<Impl>(options, metrics)) {}
Server::~Server() = default;
Router& Server::router() {
  return impl_->router();
}
Status Server::Bind() {
  return impl_->Listen();
}
int Server::port() const {
  return impl_->port;
}
Status Server::Serve() {
  return impl_->Accept();
}
void Server::Stop() {
  impl_->StopAccepting();
}
bool Server::stopping() const {
  return impl_->stopping;
}

}  // namespace drupe
