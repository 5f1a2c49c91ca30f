#include "http/server.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "http/client.h"
#include "http/content.h"

namespace drupe {
namespace {

using std::chrono::milliseconds;

/// A client that sends exactly the bytes it is told to.
class RawSocket {
 public:
  explicit RawSocket(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
    const timeval patience{5, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  }
  ~RawSocket() { ::close(socket_); }
  RawSocket(const RawSocket&) = delete;
  RawSocket& operator=(const RawSocket&) = delete;

  bool Send(std::string_view bytes) {
    return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
  }
  /// Everything until the server closes.
  std::string ReadAll() { return ReadUntil("\x01never"); }
  std::string ReadUntil(std::string_view end) {
    std::string text;
    char buffer[4096];
    while (text.find(end) == std::string::npos) {
      const ssize_t count = ::recv(socket_, buffer, sizeof(buffer), 0);
      if (count <= 0) break;
      text.append(buffer, static_cast<std::size_t>(count));
    }
    return text;
  }
  void Close() { ::shutdown(socket_, SHUT_RDWR); }
  bool connected() const { return connected_; }

 private:
  int socket_;
  bool connected_;
};

/// Asks again until `condition` holds, for up to a minute: what one thread has done, another sees when it gets its
/// turn.
template <typename Condition>
bool Eventually(const Condition& condition) {
  for (int i = 0; i < 3000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(milliseconds(20));
  }
  return false;
}

int Count(std::string_view text, std::string_view what) {
  int count = 0;
  for (std::size_t at = text.find(what); at != std::string_view::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

class ServerTest : public testing::Test {
 protected:
  ServerTest() {
    options_.max_connections = 6;
    options_.reserved_connections = 2;
    options_.max_event_streams = 1;
    options_.max_concurrent_uploads = 1;
    options_.head_timeout = milliseconds(600);
    options_.keep_alive_timeout = milliseconds(1000);
    options_.stall_timeout = milliseconds(600);
  }

  void Start() {
    server_ = std::make_unique<Server>(options_, &metrics_);
    AddRoutes(server_->router());
    const Status bound = server_->Bind();
    ASSERT_TRUE(bound.ok()) << bound.message();
    listener_ = std::thread([this] { served_ = server_->Serve(); });
  }

  void Stop() {
    if (!listener_.joinable()) return;
    server_->Stop();
    listener_.join();
    EXPECT_TRUE(served_.ok()) << served_.message();
  }

  ~ServerTest() override { Stop(); }

  void AddRoutes(Router& router) {
    router.Add("GET", "/hello", {},
               [](const Request&, Response& response) { response.SetText("hello", "text/plain"); });
    router.Add("GET", "/healthz", {.reserved = true},
               [](const Request&, Response& response) { response.SetText("fine", "text/plain"); });
    router.Add("GET", "/throw", {}, [](const Request&, Response&) { throw std::runtime_error("secret detail"); });
    router.Add("POST", "/ignore", {},
               [](const Request&, Response& response) { response.SetText("ignored", "text/plain"); });
    router.Add("POST", "/echo", {.max_body_bytes = 1000}, [](const Request& request, Response& response) {
      const Result<std::string> body = ReadBody(request, 1000);
      if (!body.ok()) return response.SetError(body.status());
      response.SetText(*body, "text/plain");
    });
    router.Add("POST", "/upload", {.upload = true}, [this](const Request& request, Response& response) {
      ++uploads_begun_;
      const Result<std::string> body = ReadBody(request, 1000);
      if (!body.ok()) return response.SetError(body.status());
      response.SetText("got " + std::to_string(body->size()), "text/plain");
    });
    router.Add("GET", "/big", {}, [](const Request& request, Response& response) {
      SendContent(request, MakeByteSource(std::string(1'000'000, 'b')), "text/plain", "tag", response);
    });
    router.Add("GET", "/events", {}, [this](const Request&, Response& response) {
      response.SetEvents([this, sent = 0](EventSink& sink) mutable {
        ++turns_;
        if (sent < 2) sink.Send("count", {{"n", ++sent}});
        return !end_events_;
      });
    });
    router.Add("GET", "/stream", {}, [](const Request&, Response& response) {
      response.SetStream("multipart/x-mixed-replace; boundary=frame", [sent = 0](StreamSink& sink) mutable {
        return sink.Write("piece " + std::to_string(++sent) + ";") && sent < 3;
      });
    });
  }

  std::string Exchange(const std::string& request) {
    RawSocket socket(server_->port());
    EXPECT_TRUE(socket.Send(request));
    return socket.ReadAll();
  }
  std::string Get(const std::string& path, const std::string& headers = "") {
    return Exchange("GET " + path + " HTTP/1.1\r\nHost: h\r\nConnection: close\r\n" + headers + "\r\n");
  }
  std::string Post(const std::string& path, const std::string& headers, const std::string& body) {
    return Exchange("POST " + path + " HTTP/1.1\r\nHost: h\r\nConnection: close\r\n" + headers + "\r\n" + body);
  }

  ServerOptions options_;
  Metrics metrics_;
  std::unique_ptr<Server> server_;
  std::thread listener_;
  Status served_;
  std::atomic<int> turns_{0};
  std::atomic<int> uploads_begun_{0};
  std::atomic<bool> end_events_{false};
};

void ExpectError(const std::string& reply, int http_status, std::string_view code) {
  EXPECT_TRUE(reply.starts_with("HTTP/1.1 " + std::to_string(http_status) + " ")) << reply;
  EXPECT_NE(reply.find("\"code\":\"" + std::string(code) + "\""), std::string::npos) << reply;
  EXPECT_NE(reply.find("X-Request-Id: req_"), std::string::npos) << reply;
}

TEST_F(ServerTest, Nominal) {
  Start();
  const std::string reply = Get("/hello");
  EXPECT_TRUE(reply.starts_with("HTTP/1.1 200 OK\r\n")) << reply;
  EXPECT_TRUE(reply.ends_with("\r\n\r\nhello")) << reply;
  EXPECT_NE(reply.find("Connection: close"), std::string::npos);
  EXPECT_NE(metrics_.Text().find("drupe_http_requests_total{method=\"GET\",route=\"/hello\",status=\"200\"} 1"),
            std::string::npos);
}

TEST_F(ServerTest, ErrorsHaveTheOneShape) {
  Start();
  ExpectError(Get("/nowhere"), 404, "unknown_route");
  ExpectError(Get("/%2e%2e/%2e%2e/etc/passwd"), 404, "unknown_route");
  ExpectError(Get("/hello?x=%"), 400, "invalid_parameter");
  const std::string wrong_method = Post("/hello", "Content-Length: 0\r\n", "");
  ExpectError(wrong_method, 405, "method_not_allowed");
  EXPECT_NE(wrong_method.find("Allow: GET"), std::string::npos);
}

TEST_F(ServerTest, ExceptionsDoNotLeak) {
  Start();
  const std::string reply = Get("/throw");
  ExpectError(reply, 500, "internal");
  EXPECT_EQ(reply.find("secret"), std::string::npos);
  EXPECT_EQ(reply.find("EXCEPTION_WHAT"), std::string::npos);
}

TEST_F(ServerTest, HeadHasNoBody) {
  Start();
  const std::string reply = Exchange("HEAD /hello HTTP/1.1\r\nHost: h\r\nConnection: close\r\n\r\n");
  EXPECT_TRUE(reply.starts_with("HTTP/1.1 200 OK\r\n")) << reply;
  EXPECT_NE(reply.find("Content-Length: 5"), std::string::npos) << reply;
  EXPECT_TRUE(reply.ends_with("\r\n\r\n")) << reply;
}

TEST_F(ServerTest, ChunkedAndCompressedBodiesAreRefused) {
  Start();
  ExpectError(Post("/echo", "Transfer-Encoding: chunked\r\n", "5\r\nhello\r\n0\r\n\r\n"), 411, "length_required");
  ExpectError(Post("/echo", "Transfer-Encoding: chunked\r\nContent-Length: 5\r\n", "hello"), 411, "length_required");
  ExpectError(Post("/echo", "Content-Encoding: gzip\r\nContent-Length: 5\r\n", "hello"), 415, "unsupported_encoding");
}

TEST_F(ServerTest, TooLargeIsRefusedUnread) {
  Start();
  ExpectError(Post("/echo", "Content-Length: 1001\r\n", std::string(1001, 'x')), 413, "body_too_large");
  ExpectError(Post("/echo", "Content-Length: 99999999999999\r\n", "only a little"), 413, "body_too_large");
}

TEST_F(ServerTest, UnreadBodyIsNeverTheNextRequest) {
  Start();
  const std::string smuggled = "GET /hello HTTP/1.1\r\nHost: h\r\n\r\n";
  RawSocket socket(server_->port());
  socket.Send("POST /ignore HTTP/1.1\r\nHost: h\r\nContent-Length: " + std::to_string(smuggled.size()) + "\r\n\r\n" +
              smuggled);
  const std::string reply = socket.ReadAll();
  EXPECT_EQ(Count(reply, "HTTP/1.1 "), 1) << reply;
  EXPECT_NE(reply.find("Connection: close"), std::string::npos);
}

TEST_F(ServerTest, ReadBodiesKeepTheConnection) {
  Start();
  const std::string post = "POST /echo HTTP/1.1\r\nHost: h\r\nContent-Length: 3\r\n\r\n";
  RawSocket socket(server_->port());
  socket.Send(post + "one" + post + "two" + "GET /hello HTTP/1.1\r\nHost: h\r\nConnection: close\r\n\r\n");
  const std::string reply = socket.ReadAll();
  EXPECT_EQ(Count(reply, "HTTP/1.1 200"), 3) << reply;
  EXPECT_LT(reply.find("one"), reply.find("two"));
}

TEST_F(ServerTest, ClosedIdleConnectionIsNoRequest) {
  Start();
  {
    RawSocket silent(server_->port());
    RawSocket done(server_->port());
    done.Send("GET /hello HTTP/1.1\r\nHost: h\r\n\r\n");
    done.ReadUntil("hello");
  }
  Stop();
  EXPECT_EQ(metrics_.Text().find("status=\"400\""), std::string::npos) << metrics_.Text();
}

TEST_F(ServerTest, LongHeadsAreRefused) {
  Start();
  ExpectError(Get("/hello", "X: " + std::string(20'000, 'a') + "\r\n"), 431, "headers_too_large");
  ExpectError(Get("/" + std::string(3000, 'a')), 414, "target_too_long");
  std::string many;
  for (int i = 0; i < 100; ++i) many += "X-" + std::to_string(i) + ": y\r\n";
  ExpectError(Get("/hello", many), 431, "headers_too_large");
  RawSocket endless(server_->port());
  std::string text(64 << 10, 'a');
  for (int i = 0; i < 64 && endless.Send(text); ++i) {
  }
  EXPECT_LE(Count(endless.ReadAll(), "HTTP/1.1 431"), 1);  // or the connection was cut before it could be read
}

TEST_F(ServerTest, SlowHeadsEndInTime) {
  Start();
  RawSocket socket(server_->port());
  socket.Send("GET /hello HT");
  ExpectError(socket.ReadAll(), 408, "request_timeout");
}

TEST_F(ServerTest, DrippingBodyEndsInTime) {
  options_.min_body_bytes_per_s = 100'000;
  Start();
  RawSocket socket(server_->port());
  socket.Send("POST /echo HTTP/1.1\r\nHost: h\r\nContent-Length: 900\r\n\r\n");
  const auto start = std::chrono::steady_clock::now();
  std::thread drip([&] {
    for (int i = 0; i < 40 && socket.Send("x"); ++i) std::this_thread::sleep_for(milliseconds(50));
  });
  const std::string reply = socket.ReadUntil("}}");
  EXPECT_LT(std::chrono::steady_clock::now() - start, milliseconds(1500));
  ExpectError(reply, 408, "request_timeout");
  drip.join();
}

TEST_F(ServerTest, CutBodyIsNoBody) {
  Start();
  RawSocket socket(server_->port());
  socket.Send("POST /echo HTTP/1.1\r\nHost: h\r\nContent-Length: 900\r\n\r\nfew");
  ExpectError(socket.ReadAll(), 408, "request_timeout");
}

TEST_F(ServerTest, ContinueIsSentOnlyForBodiesThatAreRead) {
  Start();
  const std::string head = " HTTP/1.1\r\nHost: h\r\nConnection: close\r\nExpect: 100-continue\r\nContent-Length: ";
  RawSocket wanted(server_->port());
  wanted.Send("POST /echo" + head + "3\r\n\r\n");
  EXPECT_NE(wanted.ReadUntil("\r\n\r\n").find("100 Continue"), std::string::npos);
  wanted.Send("abc");
  EXPECT_TRUE(wanted.ReadAll().ends_with("abc"));
  RawSocket unwanted(server_->port());
  unwanted.Send("POST /echo" + head + "5000\r\n\r\n");
  ExpectError(unwanted.ReadUntil("}}"), 413, "body_too_large");
}

TEST_F(ServerTest, ConcurrentUploadsAreLimited) {
  options_.stall_timeout = milliseconds(60'000);
  Start();
  const std::string post = "POST /upload HTTP/1.1\r\nHost: h\r\nConnection: close\r\nContent-Length: 3\r\n\r\n";
  RawSocket first(server_->port());
  first.Send(post + "a");
  EXPECT_TRUE(Eventually([&] { return uploads_begun_ > 0; }));
  const std::string refused = Exchange(post + "abc");
  ExpectError(refused, 503, "server_busy");
  EXPECT_NE(refused.find("Retry-After: "), std::string::npos);
  first.Send("bc");
  EXPECT_TRUE(first.ReadAll().ends_with("got 3"));
  EXPECT_TRUE(Exchange(post + "abc").ends_with("got 3"));
}

TEST_F(ServerTest, HealthIsAnsweredWhenEveryPlaceIsTaken) {
  options_.head_timeout = milliseconds(120'000);
  Start();
  const auto is_refused = [&](const char* path) { return Get(path).starts_with("HTTP/1.1 503 "); };
  std::vector<std::unique_ptr<RawSocket>> idle;
  for (int i = 0; i < options_.max_connections; ++i) idle.push_back(std::make_unique<RawSocket>(server_->port()));
  EXPECT_TRUE(Eventually([&] { return is_refused("/hello"); }));
  // A place is given back a moment after its reply, so what is refused for that moment is tried again as a whole.
  std::string health, hello;
  std::chrono::steady_clock::duration took{};
  EXPECT_TRUE(Eventually([&] {
    const auto start = std::chrono::steady_clock::now();
    health = Get("/healthz");
    hello = Get("/hello");
    took = std::chrono::steady_clock::now() - start;
    return health.ends_with("fine");
  })) << health;
  ExpectError(hello, 503, "server_busy");
  EXPECT_LT(took, milliseconds(1000));
  EXPECT_TRUE(Eventually([&] {
    std::vector<std::unique_ptr<RawSocket>> last;
    for (int i = 0; i < options_.reserved_connections; ++i) {
      last.push_back(std::make_unique<RawSocket>(server_->port()));
    }
    return is_refused("/healthz");
  }));
  idle.clear();
  EXPECT_TRUE(Eventually([&] { return Get("/hello").ends_with("hello"); }));
}

TEST_F(ServerTest, RangesAndEtags) {
  Start();
  EXPECT_TRUE(Get("/big", "Range: bytes=999998-\r\n").ends_with("\r\n\r\nbb"));
  EXPECT_EQ(Count(Get("/big"), "b") > 999'999, true);
  ExpectError(Get("/big", "Range: bytes=0-1,0-1\r\n"), 416, "range_not_satisfiable");
  const std::string unchanged = Get("/big", "If-None-Match: \"tag\"\r\n");
  EXPECT_TRUE(unchanged.starts_with("HTTP/1.1 304 ")) << unchanged;
  EXPECT_TRUE(unchanged.ends_with("\r\n\r\n"));
}

TEST_F(ServerTest, SecondServerOnThePortFails) {
  Start();
  ServerOptions same = options_;
  same.port = server_->port();
  Server second(same, nullptr);
  const Status bound = second.Bind();
  EXPECT_EQ(bound.code(), "port_in_use") << bound.message();
}

TEST_F(ServerTest, EventsUntilTheClientLeaves) {
  Start();
  {
    RawSocket socket(server_->port());
    socket.Send("GET /events HTTP/1.1\r\nHost: h\r\n\r\n");
    const std::string reply = socket.ReadUntil("{\"n\":2}");
    EXPECT_NE(reply.find("Content-Type: text/event-stream"), std::string::npos);
    EXPECT_NE(reply.find("event: count\ndata: {\"n\":1}\n\n"), std::string::npos);
    ExpectError(Get("/events"), 503, "server_busy");
  }
  const int turns_when_left = turns_;
  EXPECT_TRUE(Eventually([&] {
    const int turns = turns_;
    std::this_thread::sleep_for(milliseconds(500));
    return turns_ == turns;
  })) << "the stream goes on for a client that has left";
  EXPECT_LE(turns_ - turns_when_left, 3);
  end_events_ = true;
  EXPECT_NE(Get("/events").find("0\r\n\r\n"), std::string::npos);  // the place is free again
}

TEST_F(ServerTest, AStreamGoesOnUntilItsProducerEndsIt) {
  Start();
  const std::string reply = Get("/stream");
  EXPECT_NE(reply.find("Content-Type: multipart/x-mixed-replace; boundary=frame\r\n"), std::string::npos) << reply;
  for (const char* piece : {"piece 1;", "piece 2;", "piece 3;"}) EXPECT_NE(reply.find(piece), std::string::npos);
  EXPECT_TRUE(reply.ends_with("0\r\n\r\n")) << reply;
}

TEST_F(ServerTest, StopFinishesWhatIsBeingAnswered) {
  options_.stall_timeout = milliseconds(60'000);
  Start();
  RawSocket idle(server_->port());
  RawSocket events(server_->port());
  events.Send("GET /events HTTP/1.1\r\nHost: h\r\n\r\n");
  events.ReadUntil("{\"n\":1}");
  RawSocket upload(server_->port());
  upload.Send("POST /upload HTTP/1.1\r\nHost: h\r\nContent-Length: 3\r\n\r\na");
  EXPECT_TRUE(Eventually([&] { return uploads_begun_ > 0; }));
  std::thread finish([&] {
    std::this_thread::sleep_for(milliseconds(200));
    upload.Send("bc");
  });
  const int port = server_->port();
  Stop();
  finish.join();
  EXPECT_TRUE(upload.ReadAll().ends_with("got 3"));
  EXPECT_NE(events.ReadAll().find("0\r\n\r\n"), std::string::npos);
  EXPECT_FALSE(RawSocket(port).connected());
}

TEST_F(ServerTest, StopDoesNotWaitForSlowBodies) {
  options_.stall_timeout = milliseconds(5000);
  options_.stop_timeout = milliseconds(300);
  Start();
  RawSocket upload(server_->port());
  upload.Send("POST /upload HTTP/1.1\r\nHost: h\r\nContent-Length: 900\r\n\r\n");
  std::atomic<bool> stopped{false};
  std::thread drip([&] {
    while (!stopped && upload.Send("x")) std::this_thread::sleep_for(milliseconds(20));
  });
  EXPECT_TRUE(Eventually([&] { return uploads_begun_ > 0; }));
  const auto start = std::chrono::steady_clock::now();
  std::thread reader([&] {
    upload.ReadAll();
    upload.Close();
  });
  Stop();
  EXPECT_LT(std::chrono::steady_clock::now() - start, milliseconds(4000));
  stopped = true;
  drip.join();
  reader.join();
}

TEST_F(ServerTest, ClientCalls) {
  Start();
  const std::string url = "http://127.0.0.1:" + std::to_string(server_->port());
  const Result<Client> client = Client::Create(url);
  ASSERT_TRUE(client.ok());
  EXPECT_EQ(client->Post("/echo", {{"a", 1}}).value().json.dump(), "{\"a\":1}");
  EXPECT_EQ(client->Get("/nowhere").status().code(), "unknown_route");
  EXPECT_EQ(client->Get("/nowhere").status().kind(), StatusKind::kNotFound);
  EXPECT_EQ(client->Get("/hello").status().code(), "bad_reply");
  std::uint64_t bytes = 0;
  const auto count = [&](std::string_view piece) {
    bytes += piece.size();
    return true;
  };
  EXPECT_TRUE(client->Download("/big", 1'000'000, count).ok());
  EXPECT_EQ(bytes, 1'000'000u);
  EXPECT_EQ(client->Download("/big", 999'999, count).code(), "reply_too_large");
  Stop();
  EXPECT_EQ(client->Get("/hello").status().code(), "unreachable");
}

TEST(Client, Urls) {
  for (const char* url : {"", "127.0.0.1:80", "https://h:1", "http://", "http://h:0", "http://h:x", "http://h:1/path",
                          "http://u@h:1", "http://h:70000"}) {
    EXPECT_EQ(Client::Create(url).status().code(), "invalid_url") << url;
  }
  EXPECT_EQ(Client::Create("http://h:80/").value().base_url(), "http://h:80");
}

}  // namespace
}  // namespace drupe
