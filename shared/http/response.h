#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/json.h"
#include "base/status.h"

namespace drupe {

/// Bytes of known size that a reply is sent from, read piece by piece (an object of the store).
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual std::uint64_t size() const = 0;
  /// Reads at least one byte from `offset` < size(), at most buffer.size(). An error cuts the connection, so that the
  /// client cannot take the part for the whole.
  virtual Result<std::size_t> ReadAt(std::uint64_t offset, std::span<char> buffer) = 0;
};

/// A ByteSource over text in memory.
std::shared_ptr<ByteSource> MakeByteSource(std::string bytes);

/// Where a server-sent event stream is written.
class EventSink {
 public:
  virtual ~EventSink() = default;
  /// Sends one event; `data` is sent as one line of JSON. False when the client has gone.
  virtual bool Send(std::string_view event, const Json& data) = 0;
};

/// Called again and again (every 200 ms) while the client listens; sends what is new. False ends the stream. The server
/// adds a heartbeat comment every 10 s and ends the stream when it stops.
using EventProducer = std::function<bool(EventSink&)>;

/// Where a stream of bytes is written.
class StreamSink {
 public:
  virtual ~StreamSink() = default;
  /// False when the client has gone. A client that reads slowly holds up its own stream only.
  virtual bool Write(std::string_view bytes) = 0;
};

/// Called again and again (every 200 ms, or when a slow client has taken what was sent) while the client listens;
/// writes what is new. False ends the stream, which also ends when the server stops.
using StreamProducer = std::function<bool(StreamSink&)>;

/// What a handler answers. Nothing set means 200 with an empty body.
struct Response {
  int status = 200;
  std::vector<std::pair<std::string, std::string>> headers;
  std::string content_type;
  std::string body;

  /// Instead of `body`: bytes [source_offset, source_offset + source_length) of `source`.
  std::shared_ptr<ByteSource> source;
  std::uint64_t source_offset = 0;
  std::uint64_t source_length = 0;

  /// Instead of `body`: server-sent events.
  EventProducer events;

  /// Instead of `body`: bytes as they come, of `content_type`.
  StreamProducer stream;

  void SetHeader(std::string name, std::string value) { headers.emplace_back(std::move(name), std::move(value)); }
  void SetJson(const Json& json, int http_status = 200);
  void SetText(std::string text, std::string type, int http_status = 200);
  /// Replaces everything by the error of `error`; 503 and 429 get Retry-After.
  void SetError(const Status& error);
  void SetEvents(EventProducer producer) { events = std::move(producer); }
  void SetStream(std::string type, StreamProducer producer) {
    content_type = std::move(type), stream = std::move(producer);
  }
};

}  // namespace drupe
