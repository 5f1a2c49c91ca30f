#pragma once

namespace drupe {

/// One of 0-9 and a-f.
inline bool IsHexDigit(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
}

}  // namespace drupe
