#pragma once

#include <string>
#include <string_view>

namespace drupe {

/// A statement with PostgreSQL's numbered parameters in the place of each `?` outside quotes.
std::string NumberParameters(std::string_view sql);

/// A declaration of tables in SQLite's words (see Database) in PostgreSQL's: keys that count by themselves, 64-bit
/// integers, double precision, and no WITHOUT ROWID, which is PostgreSQL's only way.
std::string TranslateSchema(std::string_view sql);

/// `text` as PostgreSQL can store it: NUL bytes and what is no UTF-8 become U+FFFD.
std::string StorableText(std::string_view text);

}  // namespace drupe
