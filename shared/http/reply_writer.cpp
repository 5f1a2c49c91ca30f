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

class ChunkSink : public StreamSink {
 public:
  explicit ChunkSink(httplib::DataSink& sink) : sink_(sink) {}
  bool Write(std::string_view bytes) override { return sink_.write(bytes.data(), bytes.size()); }

 private:
  httplib::DataSink& sink_;
};

class SseSink : public EventSink {
 public:
  explicit SseSink(StreamSink& sink) : sink_(sink) {}
  bool Send(std::string_view event, const Json& data) override {
    const std::string text = "event: " + std::string(event) + "\ndata: " + DumpJson(data) + "\n\n";
    sent_ = true;
    return sink_.Write(text);
  }
  bool sent() const { return sent_; }

 private:
  StreamSink& sink_;
  bool sent_ = false;
};

/// One turn of an event stream: what is new, or a heartbeat when nothing has been for a while.
bool SendEvents(const EventProducer& producer, SteadyClock::time_point& last_sent, StreamSink& sink) {
  SseSink events(sink);
  if (!producer(events)) return false;
  const SteadyClock::time_point now = SteadyClock::now();
  if (events.sent()) last_sent = now;
  if (now - last_sent < kHeartbeat) return true;
  last_sent = now;
  return sink.Write(": heartbeat\n\n");
}

StreamProducer StreamOf(EventProducer producer) {
  auto last_sent = std::make_shared<SteadyClock::time_point>(SteadyClock::now());
  return
      [producer = std::move(producer), last_sent](StreamSink& sink) { return SendEvents(producer, *last_sent, sink); };
}

void FillFromStream(const std::string& type, StreamProducer producer, Connection& connection,
                    const std::atomic<bool>& stopping, httplib::Response& reply) {
  reply.set_header("Cache-Control", "no-store");
  reply.set_header("X-Accel-Buffering", "no");  // a proxy must pass events on at once
  auto is_first = std::make_shared<bool>(true);
  reply.set_chunked_content_provider(
      type, [producer = std::move(producer), is_first, &connection, &stopping](std::size_t, httplib::DataSink& sink) {
        if (!std::exchange(*is_first, false)) std::this_thread::sleep_for(kEventPoll);
        if (connection.PeerHasGone()) return false;
        ChunkSink chunks(sink);
        if (stopping || !producer(chunks)) sink.done();
        return true;
      });
}

}  // namespace

void FillReply(Response response, Connection& connection, const std::atomic<bool>& stopping, httplib::Response& reply) {
  reply.status = response.status;
  for (const auto& [name, value] : response.headers) reply.set_header(name, value);
  if (response.events) {
    FillFromStream("text/event-stream", StreamOf(std::move(response.events)), connection, stopping, reply);
  } else if (response.stream) {
    FillFromStream(response.content_type, std::move(response.stream), connection, stopping, reply);
  } else if (response.source) {
    FillFromSource(response, reply);
  } else if (!response.body.empty()) {
    reply.set_content(response.body, response.content_type);
  }
}

}  // namespace drupe
