#include "jobs/postgres/dialect.h"

#include <array>
#include <cstdint>
#include <utility>

namespace drupe {

namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

// In this order: the first holds the second.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kWords = {{
    {"INTEGER PRIMARY KEY AUTOINCREMENT", "BIGINT GENERATED ALWAYS AS IDENTITY PRIMARY KEY"},
    {"INTEGER", "BIGINT"},
    {"REAL", "DOUBLE PRECISION"},
    {" WITHOUT ROWID", ""},
}};

/// Continuation bytes that the first byte of a UTF-8 sequence asks for; -1 for one that starts none.
int ContinuationCount(unsigned char first) {
  if (first < 0x80) return first == 0 ? -1 : 0;
  if (first >= 0xC2 && first < 0xE0) return 1;
  if (first >= 0xE0 && first < 0xF0) return 2;
  return first >= 0xF0 && first < 0xF5 ? 3 : -1;
}

/// Whether the second byte keeps the sequence from being overlong, a surrogate or beyond U+10FFFF (RFC 3629).
bool IsSecondByte(unsigned char first, unsigned char second) {
  switch (first) {
    case 0xE0:
      return second >= 0xA0;
    case 0xED:
      return second < 0xA0;
    case 0xF0:
      return second >= 0x90;
    case 0xF4:
      return second < 0x90;
    default:
      return true;
  }
}

/// Bytes of the valid sequence at the start of `text`, which is not empty; 0 when there is none.
std::size_t SequenceLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const int count = ContinuationCount(byte(0));
  if (count < 0 || text.size() <= static_cast<std::size_t>(count)) return 0;
  const auto length = static_cast<std::size_t>(count) + 1;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  return count == 0 || IsSecondByte(byte(0), byte(1)) ? length : 0;
}

}  // namespace

std::string NumberParameters(std::string_view sql) {
  std::string numbered;
  int next = 1;
  bool quoted = false;
  for (const char c : sql) {
    if (c == '\'') quoted = !quoted;
    if (c == '?' && !quoted) {
      numbered += "$" + std::to_string(next++);
    } else {
      numbered.push_back(c);
    }
  }
  return numbered;
}

std::string TranslateSchema(std::string_view sql) {
  std::string translated(sql);
  for (const auto& [word, ours] : kWords) {
    for (std::size_t at = 0; (at = translated.find(word, at)) != std::string::npos; at += ours.size()) {
      translated.replace(at, word.size(), ours);
    }
  }
  return translated;
}

std::string StorableText(std::string_view text) {
  std::string storable;
  storable.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = SequenceLength(text);
    storable += length > 0 ? text.substr(0, length) : kReplacement;
    text.remove_prefix(length > 0 ? length : 1);
  }
  return storable;
}

}  // namespace drupe
