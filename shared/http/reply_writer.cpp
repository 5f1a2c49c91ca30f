#include "http/reply_writer.h"

#include <httplib.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

#include "base/log.h"

namespace drupe {

namespace {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

constexpr std::size_t kPieceBytes = 128 << 10;
constexpr milliseconds kEventPoll{200};
constexpr milliseconds kHeartbeat{10'000};

/// Sends the next piece of a source; `sent` bytes of the window have gone already.
bool SendPiece(ByteSource& source, std::uint64_t offset, std::uint64_t left, httplib::DataSink& sink) {
  std::vector<char> buffer(static_cast<std::size_t>(std::min<std::uint64_t>(left, kPieceBytes)));
  const Result<std::size_t> count = source.ReadAt(offset, buffer);
  if (!count.ok() || *count == 0) {
    Log(LogLevel::kError, "a reply was cut",
        {{"error", count.ok() ? "source ended early" : count.status().ToString()}});
    return false;
  }
  return sink.write(buffer.data(), *count);
}

void FillFromSource(const Response& response, httplib::Response& reply) {
  if (response.source_length == 0) return;
  reply.set_content_provider(static_cast<std::size_t>(response.source_length), response.content_type,
                             [source = response.source, start = response.source_offset](
                                 std::size_t offset, std::size_t left, httplib::DataSink& sink) {
                               return SendPiece(*source, start + offset, left, sink);
                             });
}

class SseSink : public EventSink {
 public:
  explicit SseSink(httplib::DataSink& sink) : sink_(sink) {}
  bool Send(std::string_view event, const Json& data) override {
    const std::string text = "event: " + std::string(event) + "\ndata: " + DumpJson(data) + "\n\n";
    sent_ = true;
    return sink_.write(text.data(), text.size());
  }
  bool sent() const { return sent_; }

 private:
  httplib::DataSink& sink_;
  bool sent_ = false;
};

/// One turn of an event stream: what is new, or a heartbeat when nothing has been for a while.
bool SendEvents(const EventProducer& producer, SteadyClock::time_point& last_sent, httplib::DataSink& sink) {
  constexpr std::string_view kComment = ": heartbeat\n\n";
  SseSink events(sink);
  const bool more = producer(events);
  if (!more) {
    sink.done();
    return true;
  }
  const SteadyClock::time_point now = SteadyClock::now();
  if (events.sent()) last_sent = now;
  if (now - last_sent < kHeartbeat) return true;
  last_sent = now;
  return sink.write(kComment.data(), kComment.size());
}

void FillFromEvents(EventProducer producer, Connection& connection, const std::atomic<bool>& stopping,
                    httplib::Response& reply) {
  reply.set_header("Cache-Control", "no-store");
  reply.set_header("X-Accel-Buffering", "no");  // a proxy must pass events on at once
  auto last_sent = std::make_shared<SteadyClock::time_point>(SteadyClock::now());
  auto is_first = std::make_shared<bool>(true);
  reply.set_chunked_content_provider("text/event-stream",
                                     [producer = std::move(producer), last_sent, is_first, &connection, &stopping](
                                         std::size_t, httplib::DataSink& sink) {
                                       if (!std::exchange(*is_first, false)) std::this_thread::sleep_for(kEventPoll);
                                       if (connection.PeerHasGone()) return false;
                                       if (stopping) {
                                         sink.done();
                                         return true;
                                       }
                                       return SendEvents(producer, *last_sent, sink);
                                     });
}

}  // namespace

void FillReply(Response response, Connection& connection, const std::atomic<bool>& stopping, httplib::Response& reply) {
  reply.status = response.status;
  for (const auto& [name, value] : response.headers) reply.set_header(name, value);
  if (response.events) {
    FillFromEvents(std::move(response.events), connection, stopping, reply);
  } else if (response.source) {
    FillFromSource(response, reply);
  } else if (!response.body.empty()) {
    reply.set_content(response.body, response.content_type);
  }
}

}  // namespace drupe
