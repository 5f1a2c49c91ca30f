#pragma once

#include <set>
#include <string>

#include "jobs/sql/database.h"

namespace drupe {

/// Every digest in any text column of the database's tables: what jobs, image sets, reports and all else refer to. A
/// later table is found without being named here.
Result<std::set<std::string>> ReferencedDigests(Database& database);

}  // namespace drupe
