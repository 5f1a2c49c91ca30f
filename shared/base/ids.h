#pragma once

#include <string>
#include <string_view>

#include "base/status.h"

namespace drupe {

/// A new id: `prefix` ("rec", "img", "cal", ...), an underscore and 20 random characters of [a-z0-9] (103 bits).
std::string NewId(std::string_view prefix);

/// True for `prefix`, an underscore and 1 to 40 characters of [a-z0-9]. Ids are checked with this before they touch a
/// path or a query.
bool IsId(std::string_view text, std::string_view prefix);

/// Checks the name of an uploaded image: 1 to 128 characters of [A-Za-z0-9._-], not starting with a dot. Errors: 400
/// `invalid_name`. The name labels the image in reports; it is never used as a path inside the store.
Status CheckImageName(std::string_view name);

}  // namespace drupe
