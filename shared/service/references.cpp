#include "service/references.h"

#include "store/store_audit.h"

namespace drupe {

Result<std::set<std::string>> ReferencedDigests(Database& database) {
  std::set<std::string> digests;
  const auto scan = [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const std::vector<TextColumn> columns, database.TextColumns());
    for (const auto& [table, column] : columns) {
      DRUPE_ASSIGN_OR_RETURN(const auto rows, database.Prepare("SELECT " + column + " FROM " + table));
      for (;;) {
        DRUPE_ASSIGN_OR_RETURN(const bool more, rows->Step());
        if (!more) break;
        FindDigests(rows->Text(0), [&](std::string digest) { digests.insert(std::move(digest)); });
      }
    }
    return Status::Ok();
  };
  DRUPE_RETURN_IF_ERROR(database.Transaction(Durability::kProcessDeath, scan));
  return digests;
}

}  // namespace drupe
